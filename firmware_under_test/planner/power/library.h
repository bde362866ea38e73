// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "firmware_under_test/planner/power/curve.h"

namespace kerfbench::planner {

/// Material: f of Wang, Li, Chen 2010, eq. 1, the depth of a cut. Their P_ua is power over speed and spot
/// diameter, W / (mm/s · mm), so an energy per area, though they print W/mm².
struct Material {
  std::string name;
  std::string source;  ///< Origin of the points.
  /// Depth in mm (y) over P_ua in J/mm² (x). Begins at depth 0; the last point is where it saturates: more
  /// power cuts no deeper.
  Curve depth;
  int number{};  ///< Stable id in a library, 1 … 99999; 0: the file has none.
};

/// Laser: g of eq. 4, its power over its control signal.
struct LaserTube {
  std::string name;
  std::string source;
  std::string control_unit;  ///< Unit of the control signal, "%" or "V".
  /// Power at the sheet in W (y) over the control signal u in control_unit (x).
  Curve power;
  double full_control{};  ///< Control signal u at PWM duty 255/255; >= the curve's last.
  double least_w{};       ///< Least power that burns steadily; within the curve.
  double most_w{};        ///< Largest power that may be used; within the curve.
  int number{};           ///< Stable id in a library, as that of a material.
};

/// Reads a file. Formats: fixtures/power/mild-steel.yaml and fixtures/power/co2-tube-80w.yaml. Units must be
/// stated, points must rise strictly in both columns, unknown keys are faults. @throws PowerError with
/// "file:line: key: what is wrong" for everything that is wrong.
Material readMaterial(const std::filesystem::path& path);
LaserTube readLaser(const std::filesystem::path& path);

}  // namespace kerfbench::planner

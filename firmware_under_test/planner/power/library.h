// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "firmware_under_test/planner/power/curve.h"

namespace kerfbench::planner {

/// f of Wang, Li, Chen 2010, eq. 1: how deep a material is cut. Their P_ua is power over speed and spot
/// diameter, W / (mm/s · mm), so an energy per area, though they print W/mm².
struct Material {
  std::string name;
  std::string source;  ///< Where the points come from.
  /// x: P_ua in J/mm², y: depth in mm. Begins at depth 0; the last point is where it saturates: more power
  /// cuts no deeper.
  Curve depth;
};

/// g of eq. 4: what a laser makes of its control signal.
struct LaserTube {
  std::string name;
  std::string source;
  std::string control_unit;  ///< "%" or "V".
  /// x: control signal u in control_unit, y: power at the sheet in W.
  Curve power;
  double full_control{};  ///< u at PWM duty 255/255; >= the curve's last.
  double least_w{};       ///< Burns steadily from here on; within the curve.
  double most_w{};        ///< May be asked of it; within the curve.
};

/// Formats: fixtures/power/mild-steel.yaml and fixtures/power/co2-tube-80w.yaml. Units must be stated, points
/// must rise strictly in both columns, unknown keys are faults.
/// @throws PowerError with "file:line: key: what is wrong" for everything that is wrong.
Material readMaterial(const std::filesystem::path& path);
LaserTube readLaser(const std::filesystem::path& path);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

// Private to hil/desk.
namespace kerfbench::desk {

/// Diameter of the registration marks that a scenario gets.
inline constexpr double kMarkDiameter_mm = 3.0;

/// Where a drawing lies on the sheet and under the head, with marks around it.
struct SheetPlace {
  std::vector<Eigen::Vector2d>
      marks_mm;  ///< Centres in S: four, and a fifth that tells a sheet turned round.
  double pitch_mm{};
  double start_x_mm{};  ///< x_W of the origin of S, so that the drawing is in the middle of the field.
  double shift_y_mm{};  ///< Into the field across the web; 0 where the drawing is in it as it is.
};

/// Lays a drawing into a field. `box`: around what is cut, as it is without the shift.
SheetPlace placeOnSheet(const Eigen::AlignedBox2d& box, const Eigen::AlignedBox2d& field);

}  // namespace kerfbench::desk

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/space_path.h"

namespace kerfbench::planner {

/// Reads a contour, a point a line: x y z in mm and the axis i j k (a unit vector) of the line that begins
/// there, with blanks, tabs or commas between. '#' and ';' begin comments. `name` is for messages.
/// @throws CompensationError that lists every fault with its line.
SpaceContour readSpaceContour(const std::string& text, const std::string& name);

/// Pose of five axes: X Y Z of the focus, and a head that turns about Z by C and about its own X by A, so
/// that its axis is (sin C sin A, -cos C sin A, cos A).
struct Pose {
  Eigen::Vector3d p_mm{Eigen::Vector3d::Zero()};
  double a_deg{};  ///< Angle A, 0 … 180.
  double c_deg{};  ///< Angle C; runs on over full turns, by no more than 180 from one pose to the next.
};

/// Poses of a path. Where the axis is vertical C stays as it is (0 at the start).
std::vector<Pose> posesOf(const std::vector<SpacePoint>& path);

/// Writes a G-code line for each pose, G00 to the first and G01 from there: X Y Z A C with four decimals.
std::string writePoses(const std::vector<Pose>& poses);

}  // namespace kerfbench::planner

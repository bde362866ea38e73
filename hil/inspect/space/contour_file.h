// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::inspect {

/// A corner of a contour in space, in W, with the axis of the line that begins there: the unit normal of the
/// face that the line lies in, towards the head.
struct ContourPoint {
  Eigen::Vector3d p_W_mm{Eigen::Vector3d::Zero()};
  Eigen::Vector3d axis_W{Eigen::Vector3d::UnitZ()};
  int file_line{};
};

/// Reads a contour of straight lines: a point a line, "x y z i j k" with blanks, tabs or commas between; '#'
/// and ';' begin comments. The axis is normalised. It shares no code with the planner's reader: an error of
/// one of them must show.
/// @throws base::InputError that lists every fault as "name:line: what is wrong": what is not six finite
/// numbers, an axis that is no unit vector to 1 %, a point that is the one before, fewer than two points.
/// Arcs and curves (via, centre, bezier, spline) are refused: their chords are the planner's.
std::vector<ContourPoint> readContourFile(const std::string& text, const std::string& name);

}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/space_path.h"

namespace kerfbench::planner {

/// Distance of a curve from its chords, unless another is asked for.
inline constexpr double kChordErrorMm = 0.005;

/// Reads a contour in space; lengths in mm, with blanks, tabs or commas between. '#' and ';' begin comments.
///
///     x y z  i j k                   a point, and the axis (a unit vector) of the line that begins there
///     via x y z                      between two points: an arc through this place leads from one to the
///     other centre x y z  degrees          between two points: an arc round this centre; > 0
///     counter-clockwise as
///                                    seen along the axis of the first
///     bezier x y z  x y z  [i j k]   between two points: a cubic Bézier curve with these inner points; the
///                                    axis at its end, if the surface bends
///     spline x y z  i j k            three or more in a row: a cubic spline, its axis turning from
///                                    point to point
///
/// An arc's plane is perpendicular to the axis of its begin, to half a degree. Where a spline ends and a line
/// in another plane begins, its last place is given again as a point. Curves become chords within
/// `chord_error_mm` (1e-4 … 1), see chordsOf(). `name` is for messages.
/// @throws CompensationError that lists every fault of a line by itself, or the first of a curve, with its
/// line.
SpaceContour readSpaceContour(const std::string& text, const std::string& name,
                              double chord_error_mm = kChordErrorMm);

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

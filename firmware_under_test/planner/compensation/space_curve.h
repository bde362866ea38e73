// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "firmware_under_test/planner/compensation/space_path.h"

namespace kerfbench::planner {

/// Arc of a circle in the plane through its begin that is perpendicular to its axis.
struct SpaceArc {
  SpacePoint begin;
  Eigen::Vector3d centre_mm{Eigen::Vector3d::Zero()};
  double sweep_rad{};                                    ///< > 0 counter-clockwise as seen from the head.
  [[nodiscard]] Eigen::Vector3d at(double share) const;  ///< Place at a share 0 … 1 of the sweep.
};

/// Arc from `begin` through `via` to `end`. The axis becomes the normal of their plane on the side of
/// begin.axis. A full circle where `end` is the begin: `via` is then opposite to it and the arc runs
/// counter-clockwise. nullopt if the three lie on a straight line.
std::optional<SpaceArc> arcThrough(const SpacePoint& begin, const Eigen::Vector3d& via_mm,
                                   const Eigen::Vector3d& end_mm);

/// Cubic Bézier curve upon a surface whose normal turns evenly from one end to the other, on the great circle
/// of both.
struct SpaceCubic {
  std::array<Eigen::Vector3d, 4> p_mm;
  Eigen::Vector3d axis_begin{Eigen::Vector3d::UnitZ()};
  Eigen::Vector3d axis_end{Eigen::Vector3d::UnitZ()};
  [[nodiscard]] Eigen::Vector3d at(double t) const;
  [[nodiscard]] Eigen::Vector3d axisAt(double t) const;
};

/// Cubic spline through `points` (three or more, no two neighbours at one place), its parameter the length of
/// the chords: place, direction and curvature are continuous, and the second and the last but one point are
/// no knots, so that a curve's bend goes on to its ends.
std::vector<SpaceCubic> splineThrough(const std::vector<SpacePoint>& points);

/// Chords of a curve: their begins, each with the axis of its chord; the end of the last is the curve's.
struct Chords {
  std::vector<SpacePoint> begins;
  double error_mm{};  ///< Bound of the distance of the curve from its chords.
};

/// Divides a curve into the fewest equal parts (of the sweep, of the parameter) whose chords lie within
/// `chord_error_mm` of it; chords turn by no more than 90 degrees, axes by no more than two. The sagitta of
/// an arc is R (1 - cos h), h half of a part's angle. A part of length h of a cubic B lies within
/// h²/8 max|B''| of its chord, and B'' is largest at an end. @throws CompensationError if that takes more
/// than 100 000 chords.
Chords chordsOf(const SpaceArc& arc, double chord_error_mm);
Chords chordsOf(const SpaceCubic& cubic, double chord_error_mm);

}  // namespace kerfbench::planner

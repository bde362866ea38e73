// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/corners.h"
#include "firmware_under_test/planner/motion/s_curve.h"

namespace kerfbench::planner {

struct SpeedLimits {
  double path_mm_s{};
  double acceleration_mm_s2{};
  double period_s{};
  /// Path speed that the axes allow along a unit vector.
  std::function<double(const Eigen::Vector2d& direction)> axes_mm_s;
  double jerk_mm_s3{0.0};  ///< Most change of the acceleration, as a vector; 0: no limit.
  CornerLimits corners{};  ///< What the beam may miss of corners.
};

/// A stretch of path under one speed limit.
struct Piece {
  double length_mm{};
  double limit_mm_s{};
  Ramp ramp;
};

/// A run cut into pieces with their own limits, and the highest speed at each border, ends included, that
/// pieces and joints allow. Whether a speed can be reached from another is not considered.
///
/// With a jerk limit J the samples, one a period T, keep it as a vector. On lines the path has 0.8 J. On an
/// arc of radius R the bend has J/2, v³/R² <= J/2; of the rest the path has 0.3 J, and 0.6 J is for the
/// effect of a path acceleration a across it, 3 v a/R. A joint is a step of acceleration, which no path of
/// lines and arcs avoids; the drives receive the part of it that falls within one period: where the curvature
/// changes by k, v² k/T <= 0.6 J, where a polyline turns by t, v t/T² <= 0.6 J.
struct Pieces {
  /// Cuts a run; arcs are cut into pieces of at most `piece_rad`.
  Pieces(std::span<const Segment> run, const SpeedLimits& limits, double piece_rad);

  std::vector<Piece> pieces;
  std::vector<double> cap_mm_s;  ///< Highest speeds at the borders; one more than pieces.
  double length_mm{};
};

/// Highest speed from one segment to the next: turnSpeed(), and the limit of jerk.
double jointSpeed(const Segment& before, const Segment& after, const SpeedLimits& limits);
/// Highest speed on an arc.
double bendSpeed(double radius_mm, const SpeedLimits& limits);
/// Highest speed at which the curvature may change by this much; infinite without a limit of jerk.
double curvatureStepSpeed(double change_1_mm, const SpeedLimits& limits);

}  // namespace kerfbench::planner

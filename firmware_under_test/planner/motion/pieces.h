// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/s_curve.h"

namespace kerfbench::planner {

struct SpeedLimits {
  double path_mm_s{};
  double acceleration_mm_s2{};
  double period_s{};
  /// Path speed that the axes allow along a unit vector.
  std::function<double(const Eigen::Vector2d& direction)> axes_mm_s;
  double jerk_mm_s3{0.0};  ///< Most change of the acceleration, as a vector; 0: no limit.
};

/// A stretch of path under one speed limit.
struct Piece {
  double length_mm{};
  double limit_mm_s{};
  Ramp ramp;
};

/// A run cut up so that each piece has limits of its own, and the highest speed at each border, ends
/// included, as pieces and joints allow it: what may be reached from where is not looked at.
///
/// With a jerk J the samples, one a period T, keep it as a vector. On lines the path has 0.8 J. On an arc of
/// radius R J/2 is for the bend, v³/R² <= J/2, and of the rest 0.3 J for the path and 0.6 J for what a path
/// acceleration a does across it, 3 v a/R. A joint is a step of acceleration that no path of lines and arcs
/// is without; what the drives get of it is what comes within one period: where the curvature changes by k,
/// v² k/T <= 0.6 J, where a polyline turns by t, v t/T² <= 0.6 J.
struct Pieces {
  /// Arcs are cut into pieces of at most `piece_rad`.
  Pieces(std::span<const Segment> run, const SpeedLimits& limits, double piece_rad);

  std::vector<Piece> pieces;
  std::vector<double> cap_mm_s;  ///< One more than pieces.
  double length_mm{};
};

/// Highest speed from one segment to the next.
double jointSpeed(const Segment& before, const Segment& after, const SpeedLimits& limits);
/// Highest speed on an arc.
double bendSpeed(double radius_mm, const SpeedLimits& limits);
/// Highest speed at which the curvature may change by so much; infinite without a limit of jerk.
double curvatureStepSpeed(double change_1_mm, const SpeedLimits& limits);

}  // namespace kerfbench::planner

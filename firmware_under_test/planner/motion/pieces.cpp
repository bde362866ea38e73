// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::planner {
namespace {

/// Share of the acceleration on an arc that is normal to it; the rest is tangential: 0.8² + 0.6² = 1.
constexpr double kNormalShare = 0.8;
constexpr double kTangentShare = 0.6;
/// Share of the jerk on a line; that of a joint is across the path: 0.8² + 0.6² = 1.
constexpr double kLineJerkShare = 0.8;
constexpr double kJointJerkShare = 0.6;
/// Share of the jerk on an arc: 0.5 + 0.3 along the path and 0.6 across it make 1.
constexpr double kBendJerkShare = 0.5;
constexpr double kPathJerkShare = 0.3;
constexpr double kCrossJerkShare = 0.6;
/// Angle between directions over which the axes' limit is taken as linear.
constexpr double kLookRad = 0.1;

double signedCurvature(const Segment& segment) {
  return segment.isArc() ? std::copysign(1.0 / segment.radiusMm(), segment.sweep_rad) : 0.0;
}

Piece linePiece(const Segment& segment, const SpeedLimits& limits) {
  const double axes = limits.axes_mm_s(segment.tangentAt(0.0));
  return {segment.lengthMm(),
          std::min(limits.path_mm_s, axes),
          {limits.acceleration_mm_s2, kLineJerkShare * limits.jerk_mm_s3}};
}

/// Part i of `count` equal parts of an arc.
Piece arcPiece(const Segment& segment, int i, int count, const SpeedLimits& limits) {
  const double length_mm = segment.lengthMm();
  const double radius_mm = segment.radiusMm();
  const double jerk = limits.jerk_mm_s3;
  const int looks =
      2 * std::max(1, static_cast<int>(std::ceil(std::abs(segment.sweep_rad) / count / kLookRad)));
  double limit = std::min({limits.path_mm_s, segment.most_mm_s, bendSpeed(radius_mm, limits)});
  for (int k = 0; k <= looks; ++k) {
    const double u = static_cast<double>(k) / looks;
    limit = std::min(limit, limits.axes_mm_s(segment.tangentAt(length_mm * (i + u) / count)));
  }
  double along = kTangentShare * limits.acceleration_mm_s2;
  if (jerk > 0.0 && limit > 0.0) along = std::min(along, kCrossJerkShare * jerk * radius_mm / (3.0 * limit));
  return {length_mm / count, limit, {along, kPathJerkShare * jerk}};
}

}  // namespace

double bendSpeed(double radius_mm, const SpeedLimits& limits) {
  const double jerk = limits.jerk_mm_s3;
  const double bend = std::sqrt(kNormalShare * limits.acceleration_mm_s2 * radius_mm);
  return jerk > 0.0 ? std::min(bend, std::cbrt(kBendJerkShare * jerk * radius_mm * radius_mm)) : bend;
}

double curvatureStepSpeed(double change_1_mm, const SpeedLimits& limits) {
  if (limits.jerk_mm_s3 <= 0.0 || change_1_mm <= 1e-9) return std::numeric_limits<double>::infinity();
  return std::sqrt(kJointJerkShare * limits.jerk_mm_s3 * limits.period_s / change_1_mm);
}

double jointSpeed(const Segment& before, const Segment& after, const SpeedLimits& limits) {
  double speed =
      std::min(limits.path_mm_s,
               curvatureStepSpeed(std::abs(signedCurvature(after) - signedCurvature(before)), limits));
  const double turn = turnRad(before, after);
  if (turn <= 1e-9) return speed;
  speed = std::min(speed, turnSpeed(turn, limits.acceleration_mm_s2, limits.period_s, limits.corners));
  if (limits.jerk_mm_s3 <= 0.0) return speed;
  return std::min(speed, kJointJerkShare * limits.jerk_mm_s3 * limits.period_s * limits.period_s / turn);
}

Pieces::Pieces(std::span<const Segment> run, const SpeedLimits& limits, double piece_rad)
    : cap_mm_s{limits.path_mm_s} {
  const auto add = [&](const Piece& piece) {
    cap_mm_s.back() = std::min(cap_mm_s.back(), piece.limit_mm_s);
    cap_mm_s.push_back(piece.limit_mm_s);
    length_mm += piece.length_mm;
    pieces.push_back(piece);
  };
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i > 0) cap_mm_s.back() = std::min(cap_mm_s.back(), jointSpeed(run[i - 1], run[i], limits));
    if (!run[i].isArc()) {
      add(linePiece(run[i], limits));
      continue;
    }
    const int count = static_cast<int>(std::ceil(std::abs(run[i].sweep_rad) / piece_rad));
    for (int k = 0; k < count; ++k) add(arcPiece(run[i], k, count, limits));
  }
}

}  // namespace kerfbench::planner

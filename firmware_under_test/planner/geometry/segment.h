// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::planner {

/// A straight or circular piece of path in the sheet frame S, as in a line of G-code.
struct Segment {
  Eigen::Vector2d start_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d end_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d centre_mm{Eigen::Vector2d::Zero()};  ///< Centre of an arc.
  double sweep_rad{};  ///< Sweep of an arc; 0: straight; > 0 counter-clockwise; ±2 pi: full circle.
  bool jump{};         ///< True for a jump (G00).
  double z{};          ///< S4's laser word: 0 off, 1 cuts through.
  int entity{-1};      ///< Entity of the dieline; -1 unknown.
  int line{};          ///< Line of the G-code; 0 if it has none.
  /// Highest speed that the segment itself admits, for a rounded corner (motion/corners.h).
  double most_mm_s{std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool isArc() const { return sweep_rad != 0.0; }
  [[nodiscard]] bool isCircle() const;
  [[nodiscard]] double radiusMm() const;
  [[nodiscard]] double lengthMm() const;
  /// Point and unit tangent at arc length s in [0, lengthMm()]. The radius runs linearly from that of the
  /// start to that of the end, so that the rounding of I and J leaves no step.
  [[nodiscard]] Eigen::Vector2d at(double s_mm) const;
  [[nodiscard]] Eigen::Vector2d tangentAt(double s_mm) const;
  [[nodiscard]] Segment reversed() const;
  /// Part between two arc lengths.
  [[nodiscard]] Segment part(double from_mm, double to_mm) const;
};

/// Cross product of plane vectors.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Angle by which the path turns at the joint from a to b, 0 … pi.
double turnRad(const Segment& a, const Segment& b);

/// Largest turn of a joint within one line of the drawing, as curves that were flattened have; joints that
/// turn by more are corners of the drawing, where an order may break it. The motion knows no such limit: see
/// motion/corners.h.
inline constexpr double kTangentRad = 0.05;

/// Path in reverse: order and sense of its segments reversed.
std::vector<Segment> reversedPath(const std::vector<Segment>& path);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Largest turn of a joint that is run through (at a speed that the turn allows); other joints are corners.
inline constexpr double kTangentRad = 0.05;

/// Path in reverse: order and sense of its segments reversed.
std::vector<Segment> reversedPath(const std::vector<Segment>& path);

}  // namespace kerfbench::planner

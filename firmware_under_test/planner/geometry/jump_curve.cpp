// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/geometry/jump_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Turn and length below which an arc or a line is rounding: 1e-7 rad of 5 mm is half a nanometre.
constexpr double kNoTurnRad = 1e-7;
constexpr double kNoLengthMm = 1e-9;
/// Difference of distances below which centres are equally near.
constexpr double kEqualMm = 1e-6;

Vector2d leftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

/// Vector turned by an angle whose sine is given and whose cosine is not negative.
Vector2d turned(const Vector2d& v, double sine) {
  return std::sqrt(std::max(0.0, 1.0 - sine * sine)) * v + sine * leftOf(v);
}

/// Signed angle of a turn to the left (+1) or right (-1), in [0, 2 pi) of that sense.
double turnOf(const Vector2d& from, const Vector2d& to, int side) {
  double angle = side * std::atan2(cross(from, to), from.dot(to));
  if (angle < 0.0) angle += 2.0 * std::numbers::pi;
  const bool none = angle < kNoTurnRad || angle > 2.0 * std::numbers::pi - kNoTurnRad;
  return none ? 0.0 : side * angle;
}

Segment jumpSegment(const Vector2d& from_mm, const Vector2d& to_mm) {
  Segment segment;
  segment.start_mm = from_mm;
  segment.end_mm = to_mm;
  segment.jump = true;
  return segment;
}

struct Candidate {
  double apart_mm{};
  std::vector<Segment> path;
};

}  // namespace

double lengthOf(const std::vector<Segment>& path) {
  double length_mm = 0.0;
  for (const Segment& segment : path) length_mm += segment.lengthMm();
  return length_mm;
}

double longestJumpMm(const JumpEnds& ends, double radius_mm) {
  return (ends.to_mm - ends.from_mm).norm() + 2.0 * std::numbers::pi * radius_mm;
}

double paperRadiusMm(double larger_side_mm) {
  const double decades = std::log10(std::max(larger_side_mm, 10.0) / 10.0);
  return std::min(1.0 + 4.0 * decades, 5.0);
}

std::optional<std::vector<Segment>> jumpOver(const JumpEnds& ends, double radius_mm, JumpSides sides) {
  if (!(radius_mm > 0.0)) {
    throw std::invalid_argument(fmt::format("the radius of a jump must be > 0, but is {:g}", radius_mm));
  }
  const Vector2d first = ends.from_mm + sides.first * radius_mm * leftOf(ends.from_direction);
  const Vector2d second = ends.to_mm + sides.second * radius_mm * leftOf(ends.to_direction);
  const Vector2d between = second - first;
  const double apart_mm = between.norm();
  Vector2d along = ends.from_direction;  // Direction of the line.
  if (sides.first == sides.second) {
    // Two equal circles have no line: the beam turns until it points in the right direction.
    along = apart_mm > kNoLengthMm ? Vector2d(between / apart_mm) : ends.to_direction;
  } else {
    if (apart_mm < 2.0 * radius_mm - kNoLengthMm) return std::nullopt;
    // The line crosses that of the centres half-way: the sine of its angle with it is R over half the
    // distance.
    along = turned(between / apart_mm, sides.first * std::min(1.0, 2.0 * radius_mm / apart_mm));
  }
  const Vector2d leaves = first - sides.first * radius_mm * leftOf(along);
  const Vector2d meets = second - sides.second * radius_mm * leftOf(along);

  std::vector<Segment> path;
  const auto addArc = [&](const Vector2d& from, const Vector2d& to, const Vector2d& centre,
                          double sweep_rad) {
    if (sweep_rad == 0.0) return;
    Segment arc = jumpSegment(from, to);
    arc.centre_mm = centre;
    arc.sweep_rad = sweep_rad;
    path.push_back(arc);
  };
  addArc(ends.from_mm, leaves, first, turnOf(ends.from_direction, along, sides.first));
  if ((meets - leaves).norm() > kNoLengthMm) path.push_back(jumpSegment(leaves, meets));
  addArc(meets, ends.to_mm, second, turnOf(along, ends.to_direction, sides.second));
  if (!path.empty()) {
    path.front().start_mm = ends.from_mm;
    path.back().end_mm = ends.to_mm;
  }
  return path;
}

std::optional<std::vector<Segment>> smoothJump(const JumpEnds& ends, double radius_mm) {
  std::vector<Candidate> candidates;
  for (const JumpSides sides : {JumpSides{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
    auto path = jumpOver(ends, radius_mm, sides);
    if (!path || lengthOf(*path) > longestJumpMm(ends, radius_mm)) continue;
    const Vector2d first = ends.from_mm + sides.first * radius_mm * leftOf(ends.from_direction);
    const Vector2d second = ends.to_mm + sides.second * radius_mm * leftOf(ends.to_direction);
    candidates.push_back({(second - first).norm(), std::move(*path)});
  }
  if (candidates.empty()) return std::nullopt;
  const auto nearer = [](const Candidate& a, const Candidate& b) { return a.apart_mm < b.apart_mm; };
  const double least_mm = std::min_element(candidates.begin(), candidates.end(), nearer)->apart_mm;
  std::erase_if(candidates, [&](const Candidate& c) { return c.apart_mm > least_mm + kEqualMm; });
  const auto shorter = [](const Candidate& a, const Candidate& b) {
    return lengthOf(a.path) < lengthOf(b.path);
  };
  return std::min_element(candidates.begin(), candidates.end(), shorter)->path;
}

}  // namespace kerfbench::planner

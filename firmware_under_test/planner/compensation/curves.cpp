// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Angle from the arc's start to the direction of p in the arc's own sense, 0 … 2 pi.
double angleAlong(const Segment& arc, const Vector2d& p) {
  const Vector2d from = arc.start_mm - arc.centre_mm;
  const Vector2d to = p - arc.centre_mm;
  const double angle = std::atan2(cross(from, to), from.dot(to)) * (arc.sweep_rad > 0.0 ? 1.0 : -1.0);
  return angle < 0.0 ? angle + kTurn : angle;
}

void meetLines(const Segment& a, const Segment& b, std::vector<Vector2d>& out) {
  const Vector2d u = a.end_mm - a.start_mm;
  const Vector2d w = b.end_mm - b.start_mm;
  const double det = cross(u, w);
  if (std::abs(det) < 1e-14 * u.norm() * w.norm()) return;
  out.push_back(a.start_mm + cross(b.start_mm - a.start_mm, w) / det * u);
}

void meetLineCircle(const Segment& line, const Segment& arc, std::vector<Vector2d>& out) {
  const Vector2d u = line.tangentAt(0.0);
  const Vector2d foot = line.start_mm + u.dot(arc.centre_mm - line.start_mm) * u;
  const double d = (foot - arc.centre_mm).norm();
  const double r = arc.radiusMm();
  if (d > r + kTouchMm) return;
  const double half = std::sqrt(std::max(0.0, r * r - d * d));
  out.push_back(foot - half * u);
  out.push_back(foot + half * u);
}

/// Intersects two circles from the smaller one: from a centre kilometres away the half chord would be lost in
/// rounding.
void meetCircles(const Segment& one, const Segment& other, std::vector<Vector2d>& out) {
  const bool swap = one.radiusMm() > other.radiusMm();
  const Segment& a = swap ? other : one;
  const Segment& b = swap ? one : other;
  const Vector2d between = b.centre_mm - a.centre_mm;
  const double d = between.norm();
  const double ra = a.radiusMm();
  const double rb = b.radiusMm();
  if (d < kTouchMm || d > ra + rb + kTouchMm || d < std::abs(ra - rb) - kTouchMm) return;
  const Vector2d u = between / d;
  const double along = 0.5 * (d + (ra - rb) * (ra + rb) / d);
  const double half = std::sqrt(std::max(0.0, ra * ra - along * along));
  const Vector2d side(-u.y(), u.x());
  out.push_back(a.centre_mm + along * u - half * side);
  out.push_back(a.centre_mm + along * u + half * side);
}

}  // namespace

double distanceMm(const Segment& segment, const Vector2d& p_mm) {
  if (!segment.isArc()) {
    const Vector2d u = segment.end_mm - segment.start_mm;
    const double square = u.squaredNorm();
    const double t = square > 0.0 ? std::clamp(u.dot(p_mm - segment.start_mm) / square, 0.0, 1.0) : 0.0;
    return (p_mm - segment.start_mm - t * u).norm();
  }
  if (angleAlong(segment, p_mm) <= std::abs(segment.sweep_rad)) {
    return std::abs((p_mm - segment.centre_mm).norm() - segment.radiusMm());
  }
  return std::min((p_mm - segment.start_mm).norm(), (p_mm - segment.end_mm).norm());
}

double stationMm(const Segment& segment, const Vector2d& p_mm) {
  if (!segment.isArc()) {
    return std::clamp(segment.tangentAt(0.0).dot(p_mm - segment.start_mm), 0.0, segment.lengthMm());
  }
  const double sweep = std::abs(segment.sweep_rad);
  const double angle = angleAlong(segment, p_mm);
  if (angle <= sweep) return segment.radiusMm() * angle;
  return angle - sweep < kTurn - angle ? segment.lengthMm() : 0.0;
}

std::vector<Vector2d> meetings(const Segment& a, const Segment& b) {
  std::vector<Vector2d> candidates{a.start_mm, a.end_mm, b.start_mm, b.end_mm};
  if (a.isArc() && b.isArc()) {
    meetCircles(a, b, candidates);
  } else if (a.isArc()) {
    meetLineCircle(b, a, candidates);
  } else if (b.isArc()) {
    meetLineCircle(a, b, candidates);
  } else {
    meetLines(a, b, candidates);
  }
  std::erase_if(candidates, [&](const Vector2d& p) {
    return !(distanceMm(a, p) < kTouchMm && distanceMm(b, p) < kTouchMm);
  });
  return candidates;
}

Eigen::AlignedBox2d boxOf(const Segment& segment) {
  Eigen::AlignedBox2d box(segment.start_mm);
  box.extend(segment.end_mm);
  if (!segment.isArc()) return box;
  const double r = segment.radiusMm();
  for (const Vector2d& axis : {Vector2d(r, 0.0), Vector2d(-r, 0.0), Vector2d(0.0, r), Vector2d(0.0, -r)}) {
    const Vector2d p = segment.centre_mm + axis;
    if (angleAlong(segment, p) <= std::abs(segment.sweep_rad)) box.extend(p);
  }
  return box;
}

double signedAreaMm2(const std::vector<Segment>& path) {
  double area = 0.0;
  const Vector2d& o = path.front().start_mm;  // The reference point is near, so that nothing cancels.
  for (const Segment& segment : path) {
    area += 0.5 * cross(segment.start_mm - o, segment.end_mm - o);
    if (!segment.isArc()) continue;
    const double r = segment.radiusMm();
    area += 0.5 * r * r * (segment.sweep_rad - std::sin(segment.sweep_rad));
  }
  return area;
}

}  // namespace kerfbench::planner

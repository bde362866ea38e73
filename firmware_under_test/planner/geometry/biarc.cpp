// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/geometry/biarc.h"

#include <cmath>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Arc that leaves p along unit tangent t and ends at q.
Segment arcFrom(const Vector2d& p, const Vector2d& t, const Vector2d& q, double flat_mm) {
  Segment arc;
  arc.start_mm = p;
  arc.end_mm = q;
  const Vector2d chord = q - p;
  // The tangent-chord angle is half the sweep.
  const double half = std::atan2(cross(t, chord), t.dot(chord));
  const double sagitta_mm = 0.5 * chord.norm() * std::abs(std::tan(0.5 * half));
  if (sagitta_mm < flat_mm) return arc;
  arc.sweep_rad = 2.0 * half;
  arc.centre_mm = p + chord.norm() / (2.0 * std::sin(half)) * Vector2d(-t.y(), t.x());
  return arc;
}

}  // namespace

std::array<Segment, 2> biarc(const Vector2d& p0, const Vector2d& t0, const Vector2d& p1, const Vector2d& t1,
                             double flat_mm) {
  const Vector2d v = p1 - p0;
  const double vt = v.dot(t0 + t1);
  const double a = 2.0 * (1.0 - t0.dot(t1));
  const double root = std::sqrt(vt * vt + a * v.squaredNorm());
  // The root has two forms: the one without cancellation is used, and the other where the curve turns back by
  // more than a right angle.
  const double d = vt > 0.0 ? v.squaredNorm() / (vt + root) : (a > 1e-12 ? (root - vt) / a : 0.0);
  const Vector2d middle = 0.5 * (p0 + p1 + d * (t0 - t1));
  return {arcFrom(p0, t0, middle, flat_mm), arcFrom(p1, -t1, middle, flat_mm).reversed()};
}

}  // namespace kerfbench::planner

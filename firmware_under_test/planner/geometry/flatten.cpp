// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/geometry/flatten.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "firmware_under_test/planner/geometry/biarc.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Sagitta below which an arc is written as a line: half a unit of the fourth decimal.
constexpr double kFlatMm = 5e-5;
/// Chord below which an arc is written as a line: the fourth decimal of the G-code would turn its tangents by
/// more than a corner.
constexpr double kShortestMm = 0.004;
constexpr double kWidestArcRad = 2.0;
constexpr int kDeepest = 30;

double distanceTo(const Segment& segment, const Vector2d& p) {
  if (segment.isArc()) return std::abs((p - segment.centre_mm).norm() - segment.radiusMm());
  return std::abs(cross(segment.tangentAt(0.0), p - segment.start_mm));
}

void divide(const dieline::Curve& curve, double u0, double u1, double tolerance_mm, int depth,
            std::vector<Segment>& out) {
  const Vector2d p0 = dieline::pointAt(curve, u0);
  const Vector2d p1 = dieline::pointAt(curve, u1);
  std::array<Segment, 2> pair{};
  std::size_t used = 2;
  if ((p1 - p0).norm() < kShortestMm) {
    pair[0].start_mm = p0;
    pair[0].end_mm = p1;
    used = 1;
  } else {
    pair = biarc(p0, dieline::tangentAt(curve, u0), p1, dieline::tangentAt(curve, u1), kFlatMm);
  }
  bool good = true;
  for (std::size_t i = 0; i < used; ++i) good = good && std::abs(pair[i].sweep_rad) < kWidestArcRad;
  // The distance to whole circles says nothing of the extent, so the lengths must agree as well.
  double chords_mm = 0.0;
  Vector2d previous = p0;
  constexpr int kProbes = 16;
  constexpr double kBetweenProbes = 0.9;  // Share that leaves room for deviations between the probes.
  for (int i = 1; i <= kProbes; ++i) {
    const Vector2d p = dieline::pointAt(curve, u0 + (u1 - u0) * i / kProbes);
    double distance_mm = distanceTo(pair[0], p);
    if (used == 2) distance_mm = std::min(distance_mm, distanceTo(pair[1], p));
    good = good && distance_mm < kBetweenProbes * tolerance_mm;
    chords_mm += (p - previous).norm();
    previous = p;
  }
  const double length_mm = pair[0].lengthMm() + (used == 2 ? pair[1].lengthMm() : 0.0);
  good = good && std::abs(length_mm - chords_mm) < 0.01 * length_mm + tolerance_mm;
  if (good || depth >= kDeepest) {
    for (std::size_t i = 0; i < used; ++i) {
      if (pair[i].lengthMm() > 0.0) out.push_back(pair[i]);
    }
    return;
  }
  const double um = 0.5 * (u0 + u1);
  divide(curve, u0, um, tolerance_mm, depth + 1, out);
  divide(curve, um, u1, tolerance_mm, depth + 1, out);
}

}  // namespace

std::vector<Segment> flatten(const dieline::Curve& curve, double tolerance_mm) {
  if (const auto* line = std::get_if<dieline::LineCurve>(&curve)) {
    Segment segment;
    segment.start_mm = line->start_mm;
    segment.end_mm = line->end_mm;
    return {segment};
  }
  if (const auto* arc = std::get_if<dieline::ArcCurve>(&curve)) {
    Segment segment;
    const auto on = [&](double angle) {
      return Vector2d(arc->centre_mm + arc->radius_mm * Vector2d(std::cos(angle), std::sin(angle)));
    };
    segment.start_mm = on(arc->start_angle_rad);
    segment.end_mm = on(arc->start_angle_rad + arc->sweep_rad);
    segment.centre_mm = arc->centre_mm;
    segment.sweep_rad = arc->sweep_rad;
    return {segment};
  }
  std::vector<Segment> out;
  constexpr int kFirstParts = 4;  // Number of parts such that no piece has more than one inflection.
  for (int i = 0; i < kFirstParts; ++i) {
    divide(curve, double(i) / kFirstParts, double(i + 1) / kFirstParts, tolerance_mm, 0, out);
  }
  return out;
}

}  // namespace kerfbench::planner

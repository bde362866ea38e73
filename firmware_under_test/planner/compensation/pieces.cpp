// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Turn below which there is no gap that matters between the offsets.
constexpr double kNoTurnMm = 1e-8;
constexpr double kVanishedMm = 1e-9;

Vector2d leftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

double curvature(const Segment& s) {
  return s.isArc() ? (s.sweep_rad > 0.0 ? 1.0 : -1.0) / s.radiusMm() : 0.0;
}

Segment lineLike(const Segment& model, const Vector2d& from, const Vector2d& to) {
  Segment line = model;
  line.start_mm = from;
  line.end_mm = to;
  line.centre_mm = Vector2d::Zero();
  line.sweep_rad = 0.0;
  return line;
}

/// The two tangents of an extended joint.
struct Legs {
  Segment first;
  Segment second;
};

Legs legsOf(const Segment& a, const Segment& b, const Joint& joint, double side, double radius_mm) {
  const Vector2d ta = a.tangentAt(a.lengthMm());
  const Vector2d tb = b.tangentAt(0.0);
  const double reach = radius_mm * std::tan(0.5 * std::abs(joint.turn_rad));
  const Vector2d from = joint.p_mm + side * radius_mm * leftOf(ta);
  const Vector2d to = joint.p_mm + side * radius_mm * leftOf(tb);
  const Vector2d tip = from + reach * ta;
  return {lineLike(a, from, tip), lineLike(b, tip, to)};
}

/// True if all of a leg is clear of the contours. The leg is always clear of its own corner. The rest is
/// sampled, with as much more distance as the samples are apart for segments other than the two that meet
/// here.
bool legIsFree(const Segment& leg, const Contour& own, std::size_t i, const std::vector<Boxed>& obstacles,
               double radius_mm) {
  constexpr int kSamples = 16;
  const double margin = 0.5 * leg.lengthMm() / kSamples;
  const std::size_t next = (i + 1) % own.segments.size();
  Eigen::AlignedBox2d reach = boxOf(leg);
  reach.min().array() -= radius_mm + margin;
  reach.max().array() += radius_mm + margin;
  for (const Boxed& obstacle : obstacles) {
    if (!reach.intersects(obstacle.box)) continue;
    for (int k = 0; k <= kSamples; ++k) {
      const Vector2d p = leg.at(leg.lengthMm() * k / kSamples);
      if (obstacle.box.squaredExteriorDistance(p) >= std::pow(radius_mm + margin, 2)) continue;
      const auto is = [&](const Segment& s) {
        return s.start_mm == obstacle.curve.start_mm && s.end_mm == obstacle.curve.end_mm &&
               s.sweep_rad == obstacle.curve.sweep_rad;
      };
      const bool meets_here = is(own.segments[i]) || is(own.segments[next]);
      const double wanted = meets_here ? radius_mm - kTouchMm : radius_mm + margin;
      if (distanceMm(obstacle.curve, p) < wanted) return false;
    }
  }
  return true;
}

Segment arcRound(const Segment& model, const Joint& joint, double side, double radius_mm) {
  Segment arc = model;
  const Vector2d ta = model.tangentAt(model.lengthMm());
  const Eigen::Rotation2Dd turned(joint.turn_rad);
  arc.centre_mm = joint.p_mm;
  arc.start_mm = joint.p_mm + side * radius_mm * leftOf(ta);
  arc.end_mm = joint.p_mm + side * radius_mm * leftOf(turned * ta);
  arc.sweep_rad = joint.turn_rad;
  return arc;
}

}  // namespace

const char* nameOf(JointKind kind) {
  switch (kind) {
    case JointKind::kTangent:
      return "tangent";
    case JointKind::kShortened:
      return "shortened";
    case JointKind::kExtended:
      return "extended";
    case JointKind::kInserted:
      return "inserted";
  }
  return "";
}

Boxed boxed(const Segment& curve) {
  // Distances from an arc come from its centre, which may be kilometres away.
  const double slack = 1e-10 + (curve.isArc() ? 2e-15 * curve.radiusMm() : 0.0);
  return {curve, boxOf(curve), slack};
}

std::vector<Boxed> boxed(const std::vector<Contour>& contours) {
  std::vector<Boxed> all;
  for (const Contour& contour : contours) {
    for (const Segment& segment : contour.segments) all.push_back(boxed(segment));
  }
  return all;
}

bool isFree(const std::vector<Boxed>& obstacles, const Vector2d& p_mm, double radius_mm) {
  return std::none_of(obstacles.begin(), obstacles.end(), [&](const Boxed& obstacle) {
    return obstacle.box.squaredExteriorDistance(p_mm) < radius_mm * radius_mm &&
           distanceMm(obstacle.curve, p_mm) < radius_mm - obstacle.slack_mm;
  });
}

std::optional<Segment> offsetOf(const Segment& segment, double side, double radius_mm) {
  Segment moved = segment;
  if (!segment.isArc()) {
    const Vector2d by = side * radius_mm * leftOf(segment.tangentAt(0.0));
    moved.start_mm += by;
    moved.end_mm += by;
    return moved;
  }
  const double r = segment.radiusMm();
  const double wanted = r - side * (segment.sweep_rad > 0.0 ? radius_mm : -radius_mm);
  if (wanted < kVanishedMm) return std::nullopt;
  moved.start_mm = segment.centre_mm + wanted / r * (segment.start_mm - segment.centre_mm);
  moved.end_mm = segment.centre_mm + wanted / r * (segment.end_mm - segment.centre_mm);
  return moved;
}

Joint jointAfter(const Contour& contour, std::size_t i) {
  const Segment& a = contour.segments[i];
  const Segment& b = contour.segments[(i + 1) % contour.segments.size()];
  Joint joint;
  joint.segment = i;
  joint.p_mm = a.end_mm;
  const Vector2d ta = a.tangentAt(a.lengthMm());
  const Vector2d tb = b.tangentAt(0.0);
  joint.turn_rad = std::atan2(cross(ta, tb), ta.dot(tb));
  // The tangents of a cusp do not show the side of the path back; the curvatures do.
  if (std::abs(joint.turn_rad) > kPi - 1e-7) {
    joint.turn_rad = curvature(a) + curvature(b) < 0.0 ? kPi : -kPi;
  }
  return joint;
}

namespace {

/// Decides on the joint's kind and adds what goes between the two offsets.
void addJoint(const Contour& contour, double side, double radius_mm, const std::vector<Boxed>& obstacles,
              Joint& joint, std::vector<OffsetPiece>& pieces) {
  const std::size_t i = joint.segment;
  const Segment& a = contour.segments[i];
  const Segment& b = contour.segments[(i + 1) % contour.segments.size()];
  if (std::abs(joint.turn_rad) * radius_mm < kNoTurnMm) {
    joint.kind = JointKind::kTangent;
    return;
  }
  if (side * joint.turn_rad > 0.0) {
    joint.kind = JointKind::kShortened;
    return;
  }
  if (std::abs(joint.turn_rad) < 0.5 * kPi + 1e-9) {
    const Legs legs = legsOf(a, b, joint, side, radius_mm);
    if (legIsFree(legs.first, contour, i, obstacles, radius_mm) &&
        legIsFree(legs.second, contour, i, obstacles, radius_mm)) {
      joint.kind = JointKind::kExtended;
      pieces.push_back({legs.first, joint.contour, i, side, true});
      pieces.push_back({legs.second, joint.contour, i, side, true});
      return;
    }
  }
  joint.kind = JointKind::kInserted;
  pieces.push_back({arcRound(a, joint, side, radius_mm), joint.contour, i, side, true});
}

}  // namespace

std::vector<OffsetPiece> rawPieces(const std::vector<Contour>& contours, const std::vector<Boxed>& obstacles,
                                   double radius_mm, std::vector<Joint>& joints) {
  std::vector<OffsetPiece> pieces;
  for (std::size_t c = 0; c < contours.size(); ++c) {
    const Contour& contour = contours[c];
    const double side = contour.side == Side::kLeft ? 1.0 : -1.0;
    const std::size_t n = contour.segments.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Segment& a = contour.segments[i];
      if (const auto moved = offsetOf(a, side, radius_mm)) pieces.push_back({*moved, c, i, side, false});
      if ((!contour.closed && i + 1 == n) || (n == 1 && a.isCircle())) continue;
      Joint joint = jointAfter(contour, i);
      joint.contour = c;
      addJoint(contour, side, radius_mm, obstacles, joint, pieces);
      joints.push_back(joint);
    }
  }
  return pieces;
}

}  // namespace kerfbench::planner

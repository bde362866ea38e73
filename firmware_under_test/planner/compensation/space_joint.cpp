// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_joint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kRight = 0.5 * std::numbers::pi;
/// Distance, in radii, below which crossings of the fold are one.
constexpr double kSame = 1e-6;
/// Distance, in radii, below which points of a path are one; the omission shows in no distance.
constexpr double kMerged = 1e-9;

/// One of the two lines at the fold, seen from its own half plane, and the direction of the other.
struct Leg {
  Leg(double own_rad, double other_rad, double omega_rad)
      : own(own_rad),
        other(other_rad),
        v(-std::cos(own), std::sin(own)),
        nu(std::sin(own), std::cos(own)),
        w(-std::cos(other), std::sin(other) * std::cos(omega_rad)) {}
  double own;
  double other;
  Vector2d v;   ///< Direction from B along this line.
  Vector2d nu;  ///< Direction towards the line's offset.
  Vector2d w;   ///< Component of the other line's direction in this plane.

  /// Outward normal, at a place on its border, of the region that is nearer than r to the other line.
  [[nodiscard]] Vector2d outward(const Vector2d& p) const { return p - p.dot(w) * w; }
  /// Place of that border with the unit outward normal g: on the circle round B, or on the ellipse in which
  /// the other line's cylinder meets this plane, p'(I - w w')p = 1.
  [[nodiscard]] Vector2d farthest(const Vector2d& g) const {
    if (g.dot(w) <= 0.0) return g;
    const Vector2d p = g + g.dot(w) / (1.0 - w.squaredNorm()) * w;
    return p / std::sqrt(g.dot(p));
  }
};

double foldCrossing(double angle_rad) { return angle_rad > kRight ? 1.0 / std::sin(angle_rad) : 1.0; }

Vector2d clockwise(const Vector2d& v) { return {v.y(), -v.x()}; }

struct Tangent {
  Vector2d at;
  Vector2d along;
};

/// Intersection of two tangents; the place of the first if they are parallel.
Vector2d meet(const Tangent& a, const Tangent& b) {
  const double det = a.along.x() * b.along.y() - a.along.y() * b.along.x();
  if (std::abs(det) < 1e-12 * a.along.norm() * b.along.norm()) return a.at;
  const Vector2d d = b.at - a.at;
  return a.at + (d.x() * b.along.y() - d.y() * b.along.x()) / det * a.along;
}

/// Adds tangents that divide the turn between two normals where it is more than a right angle. This happens
/// above Omega = 270° only: there the other line passes below this plane.
void addBetween(const Leg& leg, const Vector2d& from, const Vector2d& to, std::vector<Tangent>& tangents) {
  double turn = std::atan2(from.y() * to.x() - from.x() * to.y(), from.dot(to));
  if (turn < -kSame) turn += 4.0 * kRight;
  const int parts = static_cast<int>(std::ceil(turn / kRight - kSame));
  for (int k = 1; k < parts; ++k) {
    const Vector2d g = Eigen::Rotation2Dd(-turn * k / parts) * from.normalized();
    tangents.push_back({leg.farthest(g), clockwise(g)});
  }
}

struct LegPath {
  double cut{};
  std::vector<Vector2d> points;
  bool drawn_back{};
};

/// Path from the end of the strict offset to the fold at x = fold, in units of the radius.
LegPath legPath(const Leg& leg, double fold) {
  LegPath path;
  const double blocked = std::max(0.0, leg.nu.dot(leg.w)) / (1.0 - leg.v.dot(leg.w));
  const double at_fold = leg.own > kRight ? -1.0 / std::tan(leg.own) : 0.0;
  path.cut = std::max(blocked, at_fold);
  path.drawn_back = blocked > at_fold + kMerged;
  const Vector2d q(fold, 0.0);
  const Vector2d p = leg.nu + path.cut * leg.v;
  if ((p - q).norm() < kMerged) return path;
  path.points.push_back(p);
  const Vector2d out_p = path.drawn_back ? leg.outward(p) : leg.nu;
  const bool on_other = leg.other > kRight && fold * std::sin(leg.other) < 1.0 + kMerged;
  const Vector2d out_q = on_other ? leg.outward(q) : Vector2d::UnitX();
  // The paper's parallel joint is as good as the tangent where it stays outside.
  const bool parallel = !path.drawn_back && on_other && leg.own < kRight && out_q.dot(leg.nu) >= 0.0;
  std::vector<Tangent> tangents{{p, clockwise(out_p)}};
  if (!parallel) addBetween(leg, out_p, out_q, tangents);
  tangents.push_back({q, parallel ? leg.nu : clockwise(out_q)});
  for (std::size_t k = 0; k + 1 < tangents.size(); ++k) {
    const Vector2d corner = meet(tangents[k], tangents[k + 1]);
    if ((corner - path.points.back()).norm() > kMerged && (corner - q).norm() > kMerged) {
      path.points.push_back(corner);
    }
  }
  return path;
}

std::vector<Vector2d> scaled(std::vector<Vector2d> points, double radius_mm) {
  for (Vector2d& p : points) p *= radius_mm;
  return points;
}

/// Paper's joint in the half plane of a line whose partner's offset meets the fold at the joint's point.
std::vector<Vector2d> paperLeg(SpaceJoint joint, const Leg& leg, double fold, bool& exists) {
  const Vector2d t(leg.nu.y(), -leg.nu.x());
  const Vector2d q(fold, 0.0);
  if (joint == SpaceJoint::kParallel) return {leg.nu, leg.nu + q.dot(t) * t};
  if (joint == SpaceJoint::kIntersection) return {leg.nu};
  const double beyond = q.dot(leg.nu) - 1.0;  // Distance of the fold point over the offset line.
  exists = std::abs(beyond) <= 1.0;
  if (!exists) return {};
  const double along = -q.dot(t) + std::sqrt(1.0 - beyond * beyond);
  return {leg.nu - along * t};
}

/// Length of the line, in radii, that the paper's joint does without: up to its first point, or where it has
/// none up to the fold.
double paperCut(const Leg& leg, const std::vector<Vector2d>& points, double radius_mm) {
  const double cut = points.empty() ? -1.0 / std::tan(leg.own) : points.front().dot(leg.v) / radius_mm;
  return std::max(0.0, cut);
}

}  // namespace

const char* nameOf(SpaceJoint joint) {
  switch (joint) {
    case SpaceJoint::kPlanar:
      return "planar";
    case SpaceJoint::kOnePoint:
      return "one point";
    case SpaceJoint::kRadius:
      return "radius";
    case SpaceJoint::kParallel:
      return "parallel";
    case SpaceJoint::kIntersection:
      return "intersection";
    case SpaceJoint::kFixedLength:
      return "fixed length";
  }
  return "";
}

SpaceJoint FoldCorner::joint() const {
  // Supplementary angles meet the fold at one point as well, but one of the lines is shortened and one is
  // not.
  const bool alike = (alpha_rad > kRight) == (beta_rad > kRight);
  if (alike && std::abs(1.0 / std::sin(alpha_rad) - 1.0 / std::sin(beta_rad)) < kSame) {
    return SpaceJoint::kOnePoint;
  }
  const bool acute = alpha_rad < kRight && beta_rad < kRight;
  const bool obtuse = alpha_rad >= kRight && beta_rad >= kRight;
  if (acute) return SpaceJoint::kRadius;
  if (obtuse) return SpaceJoint::kFixedLength;
  return alpha_rad + beta_rad < 2.0 * kRight - kSame ? SpaceJoint::kParallel : SpaceJoint::kIntersection;
}

int FoldCorner::number() const {
  const bool first = alpha_rad < beta_rad;
  switch (joint()) {
    case SpaceJoint::kRadius:
      return first ? 1 : 4;
    case SpaceJoint::kParallel:
      return first ? 2 : 5;
    case SpaceJoint::kIntersection:
      return first ? 3 : 6;
    case SpaceJoint::kFixedLength:
      return first ? 7 : 8;
    default:
      return 0;
  }
}

FoldPath foldPath(const FoldCorner& corner, double radius_mm) {
  const Leg first(corner.alpha_rad, corner.beta_rad, corner.omega_rad);
  const Leg second(corner.beta_rad, corner.alpha_rad, corner.omega_rad);
  FoldPath path;
  if (corner.joint() == SpaceJoint::kOnePoint) {
    const double sine = std::min(std::sin(corner.alpha_rad), std::sin(corner.beta_rad));
    path.fold_mm = radius_mm / sine;
    const double cut = std::max(0.0, -radius_mm / std::tan(corner.alpha_rad));
    path.cut_first_mm = path.cut_second_mm = cut;
    return path;
  }
  const double fold = std::max(foldCrossing(corner.alpha_rad), foldCrossing(corner.beta_rad));
  const LegPath a = legPath(first, fold);
  const LegPath b = legPath(second, fold);
  path.cut_first_mm = radius_mm * a.cut;
  path.cut_second_mm = radius_mm * b.cut;
  path.first = scaled(a.points, radius_mm);
  path.second = scaled(b.points, radius_mm);
  path.fold_mm = radius_mm * fold;
  const SpaceJoint joint = corner.joint();
  path.drawn_back = a.drawn_back || b.drawn_back || joint == SpaceJoint::kIntersection;
  return path;
}

PaperPath paperPath(const FoldCorner& corner, double radius_mm) {
  const Leg first(corner.alpha_rad, corner.beta_rad, corner.omega_rad);
  const Leg second(corner.beta_rad, corner.alpha_rad, corner.omega_rad);
  const SpaceJoint joint = corner.joint();
  PaperPath path;
  if (joint == SpaceJoint::kOnePoint) {
    path.fold_mm = radius_mm / std::sin(corner.alpha_rad);
    path.cut_first_mm = path.cut_second_mm = radius_mm * paperCut(first, {}, radius_mm);
    return path;
  }
  if (joint == SpaceJoint::kRadius) {
    for (const Leg* leg : {&first, &second}) {
      const Vector2d t(leg->nu.y(), -leg->nu.x());
      const Vector2d corner_point = meet({leg->nu, t}, {Vector2d::UnitX(), Vector2d::UnitY()});
      (leg == &first ? path.first : path.second) = scaled({leg->nu, corner_point}, radius_mm);
    }
    path.fold_mm = radius_mm;
    return path;
  }
  const bool second_leads = corner.beta_rad > corner.alpha_rad;
  const Leg& other = second_leads ? first : second;
  const double fold = 1.0 / std::sin(other.other);
  (second_leads ? path.first : path.second) = scaled(paperLeg(joint, other, fold, path.exists), radius_mm);
  path.fold_mm = radius_mm * fold;
  path.cut_first_mm = radius_mm * paperCut(first, path.first, radius_mm);
  path.cut_second_mm = radius_mm * paperCut(second, path.second, radius_mm);
  return path;
}

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_shape.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kStraight_per_mm = 1e-9;
constexpr double kStepMm = 0.01;  // at which a leg is looked at
constexpr int kShapeArcPieces = 40;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector2d leftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

/// Offset of the centre line where it is carried on before the corner.
Vector2d directionOf(const CornerLeg& leg) {
  return (leg.outwards + leg.slope * leftOf(leg.outwards)).normalized();
}

double distanceToPiece(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double length2 = d.squaredNorm();
  const double u = length2 > 0.0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (a + u * d - p).norm();
}

/// Distance from the nominal path.
double offNominalMm(const CornerShape& shape, const Vector2d& p_mm) {
  const auto toLeg = [&](const CornerLeg& leg) {
    const CornerLeg::Place place = leg.placeOf(p_mm);
    return place.along_mm >= 0.0 ? std::abs(place.beside_mm) : p_mm.norm();
  };
  return std::min(toLeg(shape.in), toLeg(shape.out));
}

std::vector<Vector2d> legPoints(const CornerLeg& leg, double from_mm, double to_mm) {
  std::vector<Vector2d> points;
  const int steps = std::max(1, static_cast<int>(std::ceil((to_mm - from_mm) / kStepMm)));
  for (int i = 0; i <= steps; ++i) points.push_back(leg.at(from_mm + (to_mm - from_mm) * i / steps));
  return points;
}

}  // namespace

CornerLeg::Place CornerLeg::placeOf(const Vector2d& p_mm) const {
  const double a = p_mm.dot(outwards);
  const double n = p_mm.dot(leftOf(outwards));
  if (std::abs(bend_per_mm) < kStraight_per_mm) return {a, n};
  // On the circle of the nominal curve, written so that nothing cancels.
  const double rest = 1.0 - bend_per_mm * n;
  const double ahead = bend_per_mm * a;
  return {std::atan2(ahead, rest) / bend_per_mm,
          (n * (2.0 - bend_per_mm * n) - ahead * a) / (1.0 + std::hypot(rest, ahead))};
}

double CornerLeg::offsetAt(double along_mm) const {
  const double bent_mm = std::max(0.0, along_mm);
  return offset_mm + slope * along_mm +
         bent_mm * bent_mm * (curvature_per_mm / 2.0 + twist_per_mm2 * bent_mm / 6.0);
}

Vector2d CornerLeg::at(double along_mm) const {
  const double n = offsetAt(along_mm);
  if (std::abs(bend_per_mm) < kStraight_per_mm) return along_mm * outwards + n * leftOf(outwards);
  const double angle = bend_per_mm * along_mm;
  const Vector2d on = (std::sin(angle) * outwards + (1.0 - std::cos(angle)) * leftOf(outwards)) / bend_per_mm;
  return on + n * leftOf(Eigen::Rotation2Dd(angle) * outwards);
}

Vector2d vertexOf(const CornerLeg& in, const CornerLeg& out) {
  Eigen::Matrix2d normals;
  normals.row(0) = leftOf(directionOf(in)).transpose();
  normals.row(1) = leftOf(directionOf(out)).transpose();
  const auto aside = [](const CornerLeg& leg) {
    return (leg.offset_mm * leftOf(leg.outwards)).dot(leftOf(directionOf(leg)));
  };
  return normals.inverse() * Vector2d(aside(in), aside(out));
}

double arcLegMm(double turn_rad, double rounding_mm) {
  const double half = 0.5 * std::abs(turn_rad);
  return rounding_mm / std::max(1e-6, 1.0 / std::cos(half) - 1.0) * std::tan(half);
}

CornerPath pathOf(const CornerShape& shape, int pieces) {
  const Vector2d vertex = vertexOf(shape.in, shape.out);
  CornerPath path{vertex.dot(shape.in.outwards), vertex.dot(shape.out.outwards), {}};
  if (!(shape.rounding_mm > 0.0)) {
    path.end_in_mm -= shape.in.over_mm;
    path.end_out_mm -= shape.out.over_mm;
    return path;
  }
  const Vector2d in = -directionOf(shape.in);
  const Vector2d out = directionOf(shape.out);
  const double turn = std::atan2(cross(in, out), in.dot(out));
  const double arc_mm = arcLegMm(turn, shape.rounding_mm);
  const double radius_mm = arc_mm / std::max(1e-9, std::tan(0.5 * std::abs(turn)));
  path.end_in_mm += arc_mm * -in.dot(shape.in.outwards);
  path.end_out_mm += arc_mm * out.dot(shape.out.outwards);
  const Vector2d begin = vertex - arc_mm * in;
  const Vector2d centre = begin + std::copysign(radius_mm, turn) * leftOf(in);
  for (int i = 0; i <= pieces; ++i)
    path.arc.push_back(centre + Eigen::Rotation2Dd(turn * i / pieces) * (begin - centre));
  return path;
}

double deviationMm(const CornerShape& shape, double reach_mm) {
  const CornerPath path = pathOf(shape, kShapeArcPieces);
  const std::vector<Vector2d> in = legPoints(shape.in, path.end_in_mm, std::max(path.end_in_mm, reach_mm));
  const std::vector<Vector2d> out =
      legPoints(shape.out, path.end_out_mm, std::max(path.end_out_mm, reach_mm));
  double to_nominal = 0.0;
  double from_nominal = std::min(in.front().norm(), out.front().norm());
  for (const std::vector<Vector2d>* part : {&in, &out, &path.arc}) {
    for (std::size_t i = 0; i < part->size(); ++i) {
      to_nominal = std::max(to_nominal, offNominalMm(shape, (*part)[i]));
      if (i > 0)
        from_nominal = std::min(from_nominal, distanceToPiece(Vector2d::Zero(), (*part)[i - 1], (*part)[i]));
    }
  }
  return std::max(to_nominal, from_nominal);
}

}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner_shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace kerfbench::hil {
namespace {

using Eigen::Vector2d;

constexpr int kArcPoints = 24;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector2d leftOf(const Vector2d& v) { return {-v.y(), v.x()}; }

/// From a ray that starts in the origin.
double distanceToRay(const Vector2d& p, const Vector2d& direction) {
  return p.dot(direction) < 0.0 ? p.norm() : std::abs(cross(direction, p));
}

double radiusOf(double turn_rad, double rounding_mm) {
  return rounding_mm / std::max(1e-6, 1.0 / std::cos(0.5 * turn_rad) - 1.0);
}

/// About the vertex, from where the arc leaves one leg to where it meets the other.
std::vector<Vector2d> arcOf(const CornerShape& s) {
  const double turn = std::atan2(cross(s.tangent_in, s.tangent_out), s.tangent_in.dot(s.tangent_out));
  const double radius_mm = radiusOf(turn, s.rounding_mm);
  const Vector2d begin = -arcLegMm(turn, s.rounding_mm) * s.tangent_in;
  const Vector2d centre = begin + std::copysign(radius_mm, turn) * leftOf(s.tangent_in);
  std::vector<Vector2d> arc;
  for (int i = 0; i <= kArcPoints; ++i) {
    const double angle = turn * i / kArcPoints;
    arc.push_back(centre + Eigen::Rotation2Dd(angle) * (begin - centre));
  }
  return arc;
}

}  // namespace

Vector2d vertexOf(const Vector2d& tangent_in, double offset_in_mm, const Vector2d& tangent_out,
                  double offset_out_mm) {
  Eigen::Matrix2d normals;
  normals.row(0) = leftOf(tangent_in).transpose();
  normals.row(1) = leftOf(tangent_out).transpose();
  return normals.inverse() * Vector2d(offset_in_mm, offset_out_mm);
}

double arcLegMm(double turn_rad, double rounding_mm) {
  return radiusOf(turn_rad, rounding_mm) * std::tan(0.5 * std::abs(turn_rad));
}

double deviationMm(const CornerShape& s) {
  // A corner is cut or run over; the lesser of the two is noise.
  const bool cut = s.rounding_mm >= std::max(s.over_in_mm, s.over_out_mm);
  std::vector<Vector2d> ends{s.over_in_mm * s.tangent_in, -s.over_out_mm * s.tangent_out};
  if (cut) ends = arcOf(s);
  const Vector2d nominal = -s.vertex_mm;
  double to_nominal = 0.0;
  double from_nominal = std::min(distanceToRay(nominal - ends.front(), -s.tangent_in),
                                 distanceToRay(nominal - ends.back(), s.tangent_out));
  for (const Vector2d& end : ends) {
    const Vector2d p = s.vertex_mm + end;
    to_nominal =
        std::max(to_nominal, std::min(distanceToRay(p, -s.tangent_in), distanceToRay(p, s.tangent_out)));
    if (cut) from_nominal = std::min(from_nominal, (nominal - end).norm());
  }
  return std::max(to_nominal, from_nominal);
}

}  // namespace kerfbench::hil

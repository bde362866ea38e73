// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace kerfbench::planner {
namespace {

using Eigen::Vector3d;

double pointToLine(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - t * d).norm();
}

/// Places along a line of `length`, dense where its distance from B is small.
std::vector<double> stations(double length, double from_b, double radius_mm) {
  std::vector<double> at;
  for (double s = 0.0; s < length;) {
    at.push_back(s);
    s += std::abs(s - from_b) < 20.0 * radius_mm ? 0.02 * radius_mm : radius_mm;
  }
  at.push_back(length);
  return at;
}

double toPath(const std::vector<SpacePoint>& path, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector3d& a = path[i].p_mm;
    const Vector3d& b = path[i + 1].p_mm;
    least = std::min(least, a == b ? (p - a).norm() : pointToLine(p, a, b));
  }
  return least;
}

}  // namespace

SpaceCorner SpaceCorner::of(const FoldCorner& angles, double length_mm, Side side) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.4, Vector3d::UnitX()) *
       Eigen::AngleAxisd(-1.1, Vector3d::UnitY()))
          .toRotationMatrix();
  const double mirror = side == Side::kLeft ? 1.0 : -1.0;
  SpaceCorner c;
  c.side = side;
  c.along = turn * Vector3d(mirror, 0.0, 0.0);
  c.h1 = turn * Vector3d::UnitY();
  c.n1 = turn * Vector3d::UnitZ();
  c.h2 = std::cos(angles.omega_rad) * c.h1 + std::sin(angles.omega_rad) * c.n1;
  c.n2 = std::sin(angles.omega_rad) * c.h1 - std::cos(angles.omega_rad) * c.n1;
  c.b = Vector3d(12.0, -7.0, 30.0);
  c.a = c.b + length_mm * (-std::cos(angles.alpha_rad) * c.along + std::sin(angles.alpha_rad) * c.h1);
  c.c = c.b + length_mm * (-std::cos(angles.beta_rad) * c.along + std::sin(angles.beta_rad) * c.h2);
  return c;
}

SpaceContour SpaceCorner::contour() const {
  SpaceContour contour;
  contour.side = side;
  contour.points = {{a, n1}, {b, n2}, {c, n2}};
  return contour;
}

SpaceCheck checkCorner(const SpaceCorner& corner, const std::vector<SpacePoint>& path, double radius_mm) {
  SpaceCheck check;
  check.nearest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector3d d = path[i + 1].p_mm - path[i].p_mm;
    const double length = d.norm();
    if (length == 0.0) continue;
    const bool in_first = (path[i].axis - corner.n1).norm() < 1e-9;
    const Vector3d& n = in_first ? corner.n1 : corner.n2;
    const Vector3d& h = in_first ? corner.h1 : corner.h2;
    for (const double s : stations(length, -d.dot(path[i].p_mm - corner.b) / length, radius_mm)) {
      ++check.samples;
      const Vector3d p = path[i].p_mm + s / length * d;
      check.nearest_mm = std::min(
          {check.nearest_mm, pointToLine(p, corner.a, corner.b), pointToLine(p, corner.b, corner.c)});
      check.off_surface_mm =
          std::max({check.off_surface_mm, std::abs((p - corner.b).dot(n)), -(p - corner.b).dot(h)});
    }
  }
  const double mirror = corner.side == Side::kLeft ? 1.0 : -1.0;
  for (const bool first : {true, false}) {
    const Vector3d& from = first ? corner.a : corner.b;
    const Vector3d& to = first ? corner.b : corner.c;
    const double length = (to - from).norm();
    const Vector3d u = (to - from) / length;
    const Vector3d offset = mirror * radius_mm * (first ? corner.n1 : corner.n2).cross(u);
    for (const double s : stations(length, first ? length : 0.0, radius_mm)) {
      ++check.samples;
      const Vector3d p = from + s * u + offset;
      if ((p - corner.b).dot(first ? corner.h1 : corner.h2) < 0.0) continue;
      const double other = first ? pointToLine(p, corner.b, corner.c) : pointToLine(p, corner.a, corner.b);
      if (other < radius_mm * (1.0 + 1e-9)) continue;
      check.missed_mm = std::max(check.missed_mm, toPath(path, p));
    }
  }
  return check;
}

SpaceCheck checkJoint(const SpaceContour& contour, const SpacePath& path, const SpaceJointReport& report,
                      double radius_mm) {
  const std::size_t last = contour.points.size() - 1;
  const std::size_t from = report.point > 0 ? report.point - 1 : last - 1;
  const std::size_t to = report.point < last ? report.point + 1 : 1;
  // The path's neighbours of the joint; the first and the last point of a closed path are one.
  const std::size_t end = report.first_path_point + report.path_points;
  std::vector<SpacePoint> points(
      path.points.begin() + static_cast<std::ptrdiff_t>(report.first_path_point) - 1,
      path.points.begin() + static_cast<std::ptrdiff_t>(end));
  points.push_back(path.points[end < path.points.size() ? end : 1]);

  SpaceCorner corner;
  corner.side = contour.side;
  corner.b = contour.points[report.point].p_mm;
  const Vector3d u1 = (corner.b - contour.points[from].p_mm).normalized();
  const Vector3d u2 = (contour.points[to].p_mm - corner.b).normalized();
  corner.n1 = points.front().axis;
  corner.n2 = points[points.size() - 2].axis;
  corner.a = corner.b - (corner.b - points.front().p_mm).dot(u1) * u1;
  corner.c = corner.b + (points.back().p_mm - corner.b).dot(u2) * u2;
  const double mirror = contour.side == Side::kLeft ? 1.0 : -1.0;
  const Vector3d m = corner.n1.cross(corner.n2).normalized();
  corner.along = mirror * corner.n1.cross(u1).dot(m) > 0.0 ? m : Vector3d(-m);
  const auto across = [&](const Vector3d& v) {
    return Vector3d((v - v.dot(corner.along) * corner.along).normalized());
  };
  corner.h1 = across(-u1);
  corner.h2 = across(u2);
  return checkCorner(corner, points, radius_mm);
}

}  // namespace kerfbench::planner

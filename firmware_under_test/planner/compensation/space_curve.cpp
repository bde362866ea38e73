// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_curve.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector3d;

constexpr double kStraight = 1e-9;  ///< Sine of an angle below which three points lie on a line.
constexpr double kMostChords = 100000.0;
constexpr double kMostTurnOfAxis_rad = 2.0 * kDeg;

int partsOf(double wanted) {
  if (!(wanted <= kMostChords)) {
    throw CompensationError(
        fmt::format("the curve takes {:.3g} chords, but {:g} are the most", wanted, kMostChords));
  }
  return std::max(1, static_cast<int>(std::ceil(wanted - 1e-9)));
}

double angleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

Vector3d SpaceArc::at(double share) const {
  return centre_mm + Eigen::AngleAxisd(share * sweep_rad, begin.axis) * (begin.p_mm - centre_mm);
}

std::optional<SpaceArc> arcThrough(const SpacePoint& begin, const Vector3d& via_mm, const Vector3d& end_mm) {
  const Vector3d v = via_mm - begin.p_mm;
  const Vector3d w = end_mm - begin.p_mm;
  if (w.norm() < kStraight * v.norm()) {
    const Vector3d u = v.normalized();
    const Vector3d axis = (begin.axis - begin.axis.dot(u) * u).normalized();
    return SpaceArc{{begin.p_mm, axis}, begin.p_mm + 0.5 * v, 2.0 * kPi};
  }
  const Vector3d normal = v.cross(w);
  if (normal.norm() <= kStraight * v.norm() * w.norm()) return std::nullopt;
  const double face = normal.dot(begin.axis) < 0.0 ? -1.0 : 1.0;
  // Centre of the circle round a triangle with one corner at the origin.
  const Vector3d centre =
      (v.squaredNorm() * w.cross(normal) + w.squaredNorm() * normal.cross(v)) / (2.0 * normal.squaredNorm());
  SpaceArc arc{{begin.p_mm, face * normal.normalized()}, begin.p_mm + centre, 0.0};
  // v × w points to the side from which begin, via, end run counter-clockwise.
  const Vector3d from = -centre;
  const Vector3d to = w - centre;
  double turn = std::atan2(normal.normalized().dot(from.cross(to)), from.dot(to));
  if (turn <= 0.0) turn += 2.0 * kPi;
  arc.sweep_rad = face * turn;
  return arc;
}

Vector3d SpaceCubic::at(double t) const {
  const double s = 1.0 - t;
  return s * s * s * p_mm[0] + 3.0 * s * s * t * p_mm[1] + 3.0 * s * t * t * p_mm[2] + t * t * t * p_mm[3];
}

Vector3d SpaceCubic::axisAt(double t) const {
  const Vector3d turn = axis_begin.cross(axis_end);
  if (turn.norm() < 1e-12) return axis_begin;
  return Eigen::AngleAxisd(t * angleBetween(axis_begin, axis_end), turn.normalized()) * axis_begin;
}

std::vector<SpaceCubic> splineThrough(const std::vector<SpacePoint>& points) {
  // Slopes at the points: second derivatives agree inside; at either end the first two pieces are one cubic,
  // or where there are but two pieces each is a parabola.
  const auto n = static_cast<Eigen::Index>(points.size());
  const auto place = [&](Eigen::Index i) { return points[static_cast<std::size_t>(i)].p_mm; };
  const auto length = [&](Eigen::Index i) { return (place(i + 1) - place(i)).norm(); };
  const auto chord = [&](Eigen::Index i) {
    return Eigen::RowVector3d((place(i + 1) - place(i)) / length(i));
  };
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
  const auto addThirdDerivative = [&](Eigen::Index row, Eigen::Index piece, double factor) {
    const double weight = factor / (length(piece) * length(piece));
    system(row, piece) += weight;
    system(row, piece + 1) += weight;
    right.row(row) += 2.0 * weight * chord(piece);
  };
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    for (const Eigen::Index piece : {i - 1, i}) {
      const double h = length(piece);
      system(i, i) += 2.0 / h;
      system(i, piece == i ? i + 1 : i - 1) += 1.0 / h;
      right.row(i) += 3.0 / h * chord(piece);
    }
  }
  addThirdDerivative(0, 0, 1.0);
  addThirdDerivative(n - 1, n - 2, 1.0);
  if (n > 3) {
    addThirdDerivative(0, 1, -1.0);
    addThirdDerivative(n - 1, n - 3, -1.0);
  }
  const Eigen::MatrixX3d slopes = system.partialPivLu().solve(right);
  std::vector<SpaceCubic> cubics;
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double third = length(i) / 3.0;
    const Vector3d out = slopes.row(i).transpose();
    const Vector3d in = slopes.row(i + 1).transpose();
    cubics.push_back({{place(i), place(i) + third * out, place(i + 1) - third * in, place(i + 1)},
                      points[static_cast<std::size_t>(i)].axis.normalized(),
                      points[static_cast<std::size_t>(i + 1)].axis.normalized()});
  }
  return cubics;
}

Chords chordsOf(const SpaceArc& arc, double chord_error_mm) {
  const double radius = (arc.begin.p_mm - arc.centre_mm).norm();
  const double most = 2.0 * std::acos(std::max(1.0 - chord_error_mm / radius, std::sqrt(0.5)));
  const int parts = partsOf(std::abs(arc.sweep_rad) / most);
  Chords chords;
  chords.error_mm = radius * (1.0 - std::cos(0.5 * arc.sweep_rad / parts));
  for (int i = 0; i < parts; ++i) {
    chords.begins.push_back({arc.at(static_cast<double>(i) / parts), arc.begin.axis});
  }
  return chords;
}

Chords chordsOf(const SpaceCubic& cubic, double chord_error_mm) {
  const auto& p = cubic.p_mm;
  const double bend = 6.0 * std::max((p[0] - 2.0 * p[1] + p[2]).norm(), (p[1] - 2.0 * p[2] + p[3]).norm());
  const double turn = angleBetween(cubic.axis_begin, cubic.axis_end);
  const int parts = partsOf(std::max(std::sqrt(bend / (8.0 * chord_error_mm)), turn / kMostTurnOfAxis_rad));
  Chords chords;
  chords.error_mm = bend / (8.0 * parts * parts);
  for (int i = 0; i < parts; ++i) {
    chords.begins.push_back(
        {cubic.at(static_cast<double>(i) / parts), cubic.axisAt((static_cast<double>(i) + 0.5) / parts)});
  }
  return chords;
}

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>

namespace kerfbench::twin {
namespace {

/// Smallest s > 0 where d/dr of r (1 + k1 r² + k2 r⁴ + k3 r⁶) vanishes, s = r²; infinity if there is none
/// below 80°.
double foldSlope2(const std::array<double, 5>& k) {
  const auto growth = [&k](double s) { return 1.0 + s * (3.0 * k[0] + s * (5.0 * k[1] + s * 7.0 * k[4])); };
  constexpr double kStep = 0.005;
  double s = 0.0;
  for (int step = 0; step <= 6400; ++step, s += kStep) {
    if (growth(s + kStep) > 0.0) continue;
    double grows = s;
    double folds = s + kStep;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (grows + folds);
      (growth(middle) > 0.0 ? grows : folds) = middle;
    }
    return grows;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

PlaneProjection::PlaneProjection(const CameraDescription& camera)
    : focal_px_(camera.fx_px, camera.fy_px),
      centre_px_(camera.cx_px, camera.cy_px),
      distortion_(camera.distortion),
      telecentric_mm_(camera.telecentric_mm),
      X_CP_(camera.X_CP),
      fold_slope2_(foldSlope2(camera.distortion)) {}

PlaneProjection::Slopes PlaneProjection::distort(const Eigen::Vector2d& slopes) const {
  const auto& [k1, k2, p1, p2, k3] = distortion_;
  const double a = slopes.x();
  const double b = slopes.y();
  const double s = a * a + b * b;
  const double radial = 1.0 + s * (k1 + s * (k2 + s * k3));
  const double radial_ds = k1 + s * (2.0 * k2 + s * 3.0 * k3);
  Slopes out;
  out.value << a * radial + 2.0 * p1 * a * b + p2 * (s + 2.0 * a * a),
      b * radial + p1 * (s + 2.0 * b * b) + 2.0 * p2 * a * b;
  const double mixed = 2.0 * a * b * radial_ds + 2.0 * p1 * a + 2.0 * p2 * b;
  out.derivative << radial + 2.0 * a * a * radial_ds + 2.0 * p1 * b + 6.0 * p2 * a, mixed, mixed,
      radial + 2.0 * b * b * radial_ds + 6.0 * p1 * b + 2.0 * p2 * a;
  return out;
}

std::optional<Eigen::Vector2d> PlaneProjection::pixelOf(const Eigen::Vector2d& p_P_mm) const {
  const Eigen::Vector3d p_C = X_CP_ * Eigen::Vector3d(p_P_mm.x(), p_P_mm.y(), 0.0);
  if (!(p_C.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d slopes = p_C.head<2>() / (telecentric_mm_ > 0.0 ? telecentric_mm_ : p_C.z());
  if (!(slopes.squaredNorm() < fold_slope2_)) return std::nullopt;
  return focal_px_.cwiseProduct(distort(slopes).value) + centre_px_;
}

Eigen::Matrix2d PlaneProjection::jacobianAt(const Eigen::Vector2d& p_P_mm) const {
  const Eigen::Vector3d p_C = X_CP_ * Eigen::Vector3d(p_P_mm.x(), p_P_mm.y(), 0.0);
  const Eigen::Matrix<double, 3, 2> axes = X_CP_.linear().leftCols<2>();
  const bool pinhole = !(telecentric_mm_ > 0.0);
  const Eigen::Vector2d slopes = p_C.head<2>() / (pinhole ? p_C.z() : telecentric_mm_);
  const Eigen::Matrix2d slopes_dp =
      pinhole ? Eigen::Matrix2d((axes.topRows<2>() - slopes * axes.row(2)) / p_C.z())
              : Eigen::Matrix2d(axes.topRows<2>() / telecentric_mm_);
  return focal_px_.asDiagonal() * distort(slopes).derivative * slopes_dp;
}

std::optional<Eigen::Vector2d> PlaneProjection::planePointOf(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target = (pixel - centre_px_).cwiseQuotient(focal_px_);
  Eigen::Vector2d slopes = target;
  if (slopes.squaredNorm() >= fold_slope2_) slopes *= 0.9 * std::sqrt(fold_slope2_) / slopes.norm();
  bool found = false;
  for (int i = 0; i < 40 && !found; ++i) {
    const Slopes image = distort(slopes);
    const Eigen::Vector2d miss = target - image.value;
    Eigen::Vector2d step = image.derivative.inverse() * miss;
    // Steps never cross the fold, where the other branch begins.
    for (int halvings = 0; halvings < 30 && !((slopes + step).squaredNorm() < fold_slope2_); ++halvings)
      step *= 0.5;
    slopes += step;
    found = miss.norm() < 1e-13;
  }
  if (!found || !(slopes.squaredNorm() < fold_slope2_)) return std::nullopt;
  const Eigen::Vector3d normal_C = X_CP_.linear().col(2);
  if (telecentric_mm_ > 0.0) {
    // The ray is parallel to the camera's z.
    Eigen::Vector3d p_C(slopes.x() * telecentric_mm_, slopes.y() * telecentric_mm_, 0.0);
    p_C.z() = normal_C.dot(X_CP_.translation() - p_C) / normal_C.z();
    if (!(p_C.z() > 0.0 && std::isfinite(p_C.z()))) return std::nullopt;
    return (X_CP_.linear().transpose() * (p_C - X_CP_.translation())).head<2>();
  }
  // The ray t (a, b, 1) from the camera meets the plane where its z in P vanishes.
  const Eigen::Vector3d ray_C(slopes.x(), slopes.y(), 1.0);
  const double t = normal_C.dot(X_CP_.translation()) / normal_C.dot(ray_C);
  if (!(t > 0.0 && std::isfinite(t))) return std::nullopt;
  return (X_CP_.linear().transpose() * (t * ray_C - X_CP_.translation())).head<2>();
}

SightSlope PlaneProjection::sightSlope() const {
  if (telecentric_mm_ > 0.0) {
    const Eigen::Vector3d axis_P = X_CP_.linear().row(2).transpose();
    return {axis_P.head<2>() / std::abs(axis_P.z()), 0.0};
  }
  const Eigen::Vector3d camera_P = -(X_CP_.linear().transpose() * X_CP_.translation());
  const double height_mm = std::abs(camera_P.z());
  return {-camera_P.head<2>() / height_mm, 1.0 / height_mm};
}

PlanePatch::PlanePatch(const Nodes& nodes) {
  // A parabola through f0, f1, f2 at 0, 1/2, 1, first along each row, then down the columns.
  const auto parabola = [](const Eigen::Vector2d& f0, const Eigen::Vector2d& f1, const Eigen::Vector2d& f2) {
    return std::array<Eigen::Vector2d, 3>{f0, -3.0 * f0 + 4.0 * f1 - f2, 2.0 * f0 - 4.0 * f1 + 2.0 * f2};
  };
  std::array<std::array<Eigen::Vector2d, 3>, 3> rows;
  for (std::size_t r = 0; r < 3; ++r) rows[r] = parabola(nodes[3 * r], nodes[3 * r + 1], nodes[3 * r + 2]);
  for (std::size_t p = 0; p < 3; ++p) {
    const auto down = parabola(rows[0][p], rows[1][p], rows[2][p]);
    for (std::size_t q = 0; q < 3; ++q) c_[q][p] = down[q];
  }
}

PlaneField fieldOf(const PlaneProjection& projection, int width_px, int height_px) {
  const double right = width_px - 0.5;
  const double bottom = height_px - 0.5;
  const auto side = [&projection](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    Eigen::AlignedBox2d box;
    constexpr int kPieces = 32;
    for (int i = 0; i <= kPieces; ++i) {
      const auto point = projection.planePointOf(from + (to - from) * i / kPieces);
      if (!point) throw std::invalid_argument("camera: a border of the picture does not see the plane");
      box.extend(*point);
    }
    return box;
  };
  const std::array<Eigen::AlignedBox2d, 4> sides{
      side({-0.5, -0.5}, {right, -0.5}), side({right, -0.5}, {right, bottom}),
      side({right, bottom}, {-0.5, bottom}), side({-0.5, bottom}, {-0.5, -0.5})};
  PlaneField field;
  for (const Eigen::AlignedBox2d& box : sides) field.circumscribed.extend(box);
  field.inscribed = field.circumscribed;
  const Eigen::Vector2d middle = field.circumscribed.center();
  for (const Eigen::AlignedBox2d& box : sides) {
    // Each side bounds the box in the direction in which it lies.
    const Eigen::Vector2d away = box.center() - middle;
    const int axis = std::abs(away.x()) > std::abs(away.y()) ? 0 : 1;
    if (away[axis] > 0.0) {
      field.inscribed.max()[axis] = std::min(field.inscribed.max()[axis], box.min()[axis]);
    } else {
      field.inscribed.min()[axis] = std::max(field.inscribed.min()[axis], box.max()[axis]);
    }
  }
  return field;
}

}  // namespace kerfbench::twin

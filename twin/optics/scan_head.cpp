// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/scan_head.h"

#include <cmath>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

// Reflects a ray at a plane through `place`; nullopt if it runs away from the plane.
std::optional<Ray> reflect(const Ray& ray, const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
  const double approach = ray.direction.dot(normal);
  if (approach >= -1e-12) return std::nullopt;  // From behind, or along the mirror.
  const double distance = (place - ray.p_W_mm).dot(normal) / approach;
  if (distance < 0) return std::nullopt;
  return Ray{ray.p_W_mm + distance * ray.direction, (ray.direction - 2.0 * approach * normal).normalized()};
}

}  // namespace

ScanHead::ScanHead(double throw_mm, double mirror_spacing_mm)
    : p_WX_mm_(0.0, -mirror_spacing_mm, throw_mm), p_WY_mm_(0.0, 0.0, throw_mm) {
  if (!(throw_mm > 0) || !(mirror_spacing_mm >= 0)) {
    throw std::invalid_argument("ScanHead: throw_mm must be > 0 and mirror_spacing_mm >= 0");
  }
}

std::optional<BeamSpot> ScanHead::spotAt(const Eigen::Matrix3d& R_x, const Eigen::Matrix3d& R_y) const {
  const Eigen::Vector3d n_x = R_x * Eigen::Vector3d(-1.0, 1.0, 0.0).normalized();
  const Eigen::Vector3d n_y = R_y * Eigen::Vector3d(0.0, -1.0, -1.0).normalized();
  constexpr double kLaserDistance_mm = 500.0;
  const Ray laser{p_WX_mm_ - kLaserDistance_mm * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX()};
  const auto after_x = reflect(laser, p_WX_mm_, n_x);
  if (!after_x) return std::nullopt;
  const auto after_y = reflect(*after_x, p_WY_mm_, n_y);
  if (!after_y || after_y->direction.z() > -0.1) return std::nullopt;
  const Eigen::Vector3d& k = after_y->direction;
  const double distance = -after_y->p_W_mm.z() / k.z();
  const Eigen::Vector3d p = after_y->p_W_mm + distance * k;
  // A round beam of radius w cuts the plane in an ellipse; these are its half extents along x and y over w.
  const double cos2 = k.z() * k.z();
  return BeamSpot{p.head<2>(), std::sqrt(1.0 + k.x() * k.x() / cos2), std::sqrt(1.0 + k.y() * k.y() / cos2)};
}

BeamSpot gantrySpot(double x_mm, double y_mm) { return {{x_mm, y_mm}, 1.0, 1.0}; }

}  // namespace kerfbench::twin

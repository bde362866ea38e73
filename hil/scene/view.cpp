// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace kerfbench::scene {
namespace {

// Field of view of the wider side: a portrait lens, near enough for depth, far enough for straight
// proportions.
constexpr double kHalfAngle_rad = 0.24;

}  // namespace

Viewpoint Viewpoint::around(const std::vector<Eigen::Vector3d>& points_W_mm, const Eigen::Vector3d& direction,
                            int width_px, int height_px, double share, double right_free) {
  const Eigen::Vector3d sideways = direction.cross(Eigen::Vector3d::UnitZ());
  if (points_W_mm.empty() || width_px < 1 || height_px < 1 || !(sideways.norm() > 1e-9 * direction.norm()) ||
      !(share > 0 && share <= 1 && right_free >= 0 && 2.0 * right_free < share)) {
    throw std::invalid_argument("Viewpoint: nothing to look at, or no direction to look along");
  }
  Viewpoint view;
  view.width_px_ = width_px;
  view.height_px_ = height_px;
  view.forward_ = direction.normalized();
  view.right_ = sideways.normalized();
  view.up_ = view.right_.cross(view.forward_);
  const double aspect = static_cast<double>(height_px) / width_px;
  view.half_width_tan_ = std::tan(kHalfAngle_rad) * std::min(1.0, 1.0 / aspect);
  // Tangents from the picture's middle to its left and right, and to its lower and upper limit.
  const double tangent = view.half_width_tan_;
  const Eigen::Vector2d low_reach = share * tangent * Eigen::Vector2d(1.0, aspect);
  const Eigen::Vector2d high_reach = low_reach - Eigen::Vector2d(2.0 * right_free * tangent, 0.0);

  const Eigen::Vector3d& centre = points_W_mm.front();
  const std::array<Eigen::Vector3d, 2> axes{view.right_, view.up_};
  // From the place (s, -back) a point at (a, depth) is seen within the limits if
  // -low_reach (depth + back) <= a - s <= high_reach (depth + back).
  Eigen::Vector2d least = Eigen::Vector2d::Constant(-1e300);  // Least of s + high_reach back.
  Eigen::Vector2d most = Eigen::Vector2d::Constant(1e300);    // Most of s - low_reach back.
  for (const Eigen::Vector3d& point : points_W_mm) {
    const Eigen::Vector3d q = point - centre;
    const double depth = q.dot(view.forward_);
    const Eigen::Vector2d a(q.dot(axes[0]), q.dot(axes[1]));
    least = least.cwiseMax(a - high_reach * depth);
    most = most.cwiseMin(a + low_reach * depth);
  }
  const double back = (least - most).cwiseQuotient(low_reach + high_reach).maxCoeff();
  const Eigen::Vector2d aside = 0.5 * (least - high_reach * back + most + low_reach * back);
  view.place_mm_ = centre + aside.x() * view.right_ + aside.y() * view.up_ - back * view.forward_;
  return view;
}

Viewpoint Viewpoint::from(const Eigen::Vector3d& place_mm, const std::vector<Eigen::Vector3d>& points_W_mm,
                          int side_px, double share) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points_W_mm) box.extend(point);
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  if (!box.isEmpty()) direction = box.center() - place_mm;
  const Eigen::Vector3d sideways = direction.cross(Eigen::Vector3d::UnitZ());
  if (side_px < 1 || !(share > 0 && share <= 1) || !(sideways.norm() > 1e-9 * direction.norm()))
    throw std::invalid_argument("Viewpoint: nothing to look at, or it is straight above or below");
  Viewpoint view;
  view.width_px_ = view.height_px_ = side_px;
  view.place_mm_ = place_mm;
  view.forward_ = direction.normalized();
  view.right_ = sideways.normalized();
  view.up_ = view.right_.cross(view.forward_);
  for (const Eigen::Vector3d& point : points_W_mm) {
    const Eigen::Vector3d q = point - place_mm;
    const double depth = q.dot(view.forward_);
    if (!(depth > 0)) throw std::invalid_argument("Viewpoint: a point is not in front of it");
    const double aside = std::max(std::abs(q.dot(view.right_)), std::abs(q.dot(view.up_)));
    view.half_width_tan_ = std::max(view.half_width_tan_, aside / depth / share);
  }
  if (!(view.half_width_tan_ > 0)) throw std::invalid_argument("Viewpoint: a single point has no size");
  return view;
}

std::optional<Eigen::Vector2d> Viewpoint::project(const Eigen::Vector3d& p_W_mm) const {
  const Eigen::Vector3d q = p_W_mm - place_mm_;
  const double depth = q.dot(forward_);
  if (!(depth > 0)) return std::nullopt;
  const double px = 0.5 * width_px_ / half_width_tan_ / depth;
  return Eigen::Vector2d(0.5 * width_px_ - 0.5 + px * q.dot(right_),
                         0.5 * height_px_ - 0.5 - px * q.dot(up_));
}

double Viewpoint::pixel_mm(const Eigen::Vector3d& p_W_mm) const {
  return 2.0 * half_width_tan_ * (p_W_mm - place_mm_).dot(forward_) / width_px_;
}

}  // namespace kerfbench::scene

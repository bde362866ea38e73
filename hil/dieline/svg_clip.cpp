// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_clip.h"

#include <algorithm>
#include <cmath>

#include "hil/dieline/curve_math.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

constexpr double kEdge_mm = 1e-3;

double crossProduct(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Clipped clippedBy(const ClipRegion& region, const Curve& curve) {
  if (region.corners_mm.empty()) return Clipped::kPartly;
  bool is_inside = true;
  for (std::size_t i = 0; i < region.corners_mm.size(); ++i) {
    const Vector2d& from = region.corners_mm[i];
    const Vector2d& to = region.corners_mm[(i + 1) % region.corners_mm.size()];
    const Vector2d along = (to - from).normalized();
    // In a frame with x along the edge, y is the distance inwards.
    Eigen::Affine2d X = Eigen::Affine2d::Identity();
    X.linear() << along.x(), along.y(), -along.y(), along.x();
    X.translation() = -(X.linear() * from);
    const Eigen::AlignedBox2d box = boundsOf(transformed(curve, X));
    if (box.max().y() <= kEdge_mm && box.min().y() < -kEdge_mm) return Clipped::kWholly;
    is_inside = is_inside && box.min().y() >= -kEdge_mm;
  }
  return is_inside ? Clipped::kNot : Clipped::kPartly;
}

std::optional<std::vector<Vector2d>> convexPolygon(const std::vector<Curve>& curves,
                                                   const Eigen::Affine2d& X) {
  std::vector<Vector2d> corners;
  for (const Curve& curve : curves) {
    const auto* line = std::get_if<LineCurve>(&curve);
    if (line == nullptr) return std::nullopt;
    const Vector2d from = X * line->start_mm;
    if (corners.empty() || (from - corners.back()).norm() > kEdge_mm) corners.push_back(from);
  }
  if (corners.size() < 3) return std::nullopt;
  const Vector2d end = X * std::get<LineCurve>(curves.back()).end_mm;
  if ((end - corners.front()).norm() > kEdge_mm) return std::nullopt;
  if ((corners.back() - corners.front()).norm() <= kEdge_mm) corners.pop_back();
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    area += crossProduct(corners[i], corners[(i + 1) % corners.size()]);
  if (area < 0) std::reverse(corners.begin(), corners.end());
  double turn = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d a = corners[(i + 1) % corners.size()] - corners[i];
    const Vector2d b = corners[(i + 2) % corners.size()] - corners[(i + 1) % corners.size()];
    if (crossProduct(a, b) < -1e-9 * a.norm() * b.norm()) return std::nullopt;
    turn += std::atan2(crossProduct(a, b), a.dot(b));
  }
  // More than one turn is a star, whose corners all bend one way too.
  if (turn > 7) return std::nullopt;
  return corners;
}

}  // namespace kerfbench::dieline

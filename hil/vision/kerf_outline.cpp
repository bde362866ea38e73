// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::hil {
namespace {

constexpr int kStripLines = 9;
constexpr double kFarWidths = 4.0;
constexpr double kResolved_mm = 1e-5;

double distanceToRay(const Eigen::Vector2d& p, const Eigen::Vector2d& tangent) {
  return p.dot(tangent) > 0.0 ? p.norm() : std::abs(tangent.x() * p.y() - tangent.y() * p.x());
}

}  // namespace

double KerfOutline::shareAtEnd(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& tangent) const {
  const double across = (tangent.x() * p_mm.y() - tangent.y() * p_mm.x()) / beam_radius_mm;
  const double along = p_mm.dot(tangent) / beam_radius_mm;
  return std::exp(-2.0 * across * across) * 0.5 * std::erfc(std::numbers::sqrt2 * along);
}

bool KerfOutline::isCut(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& tangent_in,
                        const Eigen::Vector2d* tangent_out) const {
  if (!(beam_radius_mm > 0.0)) {
    if (distanceToRay(p_mm, tangent_in) < half_width_mm) return true;
    return tangent_out != nullptr && distanceToRay(p_mm, -*tangent_out) < half_width_mm;
  }
  const double h = half_width_mm / beam_radius_mm;
  double share = shareAtEnd(p_mm, tangent_in);
  if (tangent_out != nullptr) share += shareAtEnd(p_mm, -*tangent_out);
  return share > std::exp(-2.0 * h * h);
}

double KerfOutline::reachMm(const Eigen::Vector2d& direction, double strip_mm,
                            const Eigen::Vector2d& tangent_in, const Eigen::Vector2d* tangent_out) const {
  const Eigen::Vector2d beside(-direction.y(), direction.x());
  double sum = 0.0;
  for (int i = 0; i < kStripLines; ++i) {
    const double y = strip_mm * (2.0 * (i + 0.5) / kStripLines - 1.0);
    // From inside outwards; the outline crosses each line once.
    double in = -kFarWidths * half_width_mm;
    double out = kFarWidths * half_width_mm;
    while (out - in > kResolved_mm) {
      const double middle = 0.5 * (in + out);
      (isCut(middle * direction + y * beside, tangent_in, tangent_out) ? in : out) = middle;
    }
    sum += in;
  }
  return sum / kStripLines;
}

}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/nominal_head.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

namespace kerfbench::calibrate {
namespace {

bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool notNegative(double value) { return std::isfinite(value) && value >= 0.0; }

void throwIfAny(const std::string& faults) {
  if (!faults.empty()) throw std::invalid_argument(faults.substr(0, faults.size() - 2));
}

}  // namespace

Eigen::Vector2d NominalHead::angles_rad(const Eigen::Vector2d& aim_W_mm) const {
  if (focal_length_mm > 0.0) return aim_W_mm / (2.0 * focal_length_mm);
  const double reach_mm = std::hypot(throw_mm, aim_W_mm.y()) + mirror_spacing_mm;
  return 0.5 * Eigen::Vector2d(std::atan(aim_W_mm.x() / reach_mm), std::atan(aim_W_mm.y() / throw_mm));
}

Eigen::Vector2d NominalHead::aim_W_mm(const Eigen::Vector2d& angles_rad) const {
  if (focal_length_mm > 0.0) return 2.0 * focal_length_mm * angles_rad;
  const double y_mm = throw_mm * std::tan(2.0 * angles_rad.y());
  return {(std::hypot(throw_mm, y_mm) + mirror_spacing_mm) * std::tan(2.0 * angles_rad.x()), y_mm};
}

Eigen::Vector2d NominalHead::nearestAim_W_mm(const Eigen::Vector2d& wanted_W_mm) const {
  if (mirror_step_rad == 0.0) return wanted_W_mm;
  return aim_W_mm((angles_rad(wanted_W_mm) / mirror_step_rad).array().round() * mirror_step_rad);
}

Eigen::Matrix2d NominalHead::slopes_rad_mm(const Eigen::Vector2d& aim_W_mm) const {
  if (focal_length_mm > 0.0) return Eigen::Matrix2d::Identity() / (2.0 * focal_length_mm);
  const double slant_mm = std::hypot(throw_mm, aim_W_mm.y());
  const double reach_mm = slant_mm + mirror_spacing_mm;
  const double to_spot2 = reach_mm * reach_mm + aim_W_mm.x() * aim_W_mm.x();
  Eigen::Matrix2d slopes;
  slopes << reach_mm / to_spot2, -aim_W_mm.x() * aim_W_mm.y() / slant_mm / to_spot2,  //
      0.0, throw_mm / (slant_mm * slant_mm);
  return 0.5 * slopes;
}

Eigen::Matrix2d NominalHead::roundingCovariance_mm2(const Eigen::Vector2d& aim_W_mm) const {
  const Eigen::Matrix2d mm_per_rad = slopes_rad_mm(aim_W_mm).inverse();
  return mirror_step_rad * mirror_step_rad / 12.0 * mm_per_rad * mm_per_rad.transpose();
}

void check(const NominalHead& nominal) {
  std::string faults;
  if (!notNegative(nominal.focal_length_mm)) faults += "nominal.focal_length_mm must be 0 or more; ";
  if (nominal.focal_length_mm == 0.0 && !positive(nominal.throw_mm))
    faults += "nominal.throw_mm must be above 0; ";
  if (!notNegative(nominal.mirror_spacing_mm)) faults += "nominal.mirror_spacing_mm must be 0 or more; ";
  if (!notNegative(nominal.mirror_step_rad)) faults += "nominal.mirror_step_rad must be 0 or more; ";
  throwIfAny(faults);
}

void check(const HeadDesign& design) {
  std::string faults;
  if (!positive(design.throw_mm)) faults += "design.throw_mm must be above 0; ";
  if (!notNegative(design.mirror_spacing_mm)) faults += "design.mirror_spacing_mm must be 0 or more; ";
  if (design.lens) {
    if (!positive(design.lens->focal_length_mm)) faults += "design.lens.focal_length_mm must be above 0; ";
    if (!(std::abs(design.lens->k1_1_rad2) <= 10.0)) faults += "design.lens.k1_1_rad2 must be -10 … 10; ";
    if (!(std::abs(design.lens->k2_1_rad4) <= 10.0)) faults += "design.lens.k2_1_rad4 must be -10 … 10; ";
    if (!(std::abs(design.lens->incidence_ratio) <= 2.0))
      faults += "design.lens.incidence_ratio must be -2 … 2; ";
  }
  throwIfAny(faults);
}

}  // namespace kerfbench::calibrate

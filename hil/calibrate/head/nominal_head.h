// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

namespace kerfbench::calibrate {

/// The controller's formula between what it aims at, in W, and the angles of the X and the Y mirror
/// (mechanical, rad), as configured from the data sheet, whatever the head really is.
///
///   without a lens   a = ½ atan(x / (hypot(L, y) + d)),  b = ½ atan(y / L)     (Cheng et al. 2014, eq. 2)
///   with             a = x / 2f,  b = y / 2f
struct NominalHead {
  double throw_mm{};           ///< L > 0; unused with a lens.
  double mirror_spacing_mm{};  ///< d >= 0; unused with a lens.
  double focal_length_mm{};    ///< f > 0 of an f-theta lens; 0: the formula knows none.
  double mirror_step_rad{};    ///< Step to which the angles are rounded; 0: none.

  [[nodiscard]] Eigen::Vector2d angles_rad(const Eigen::Vector2d& aim_W_mm) const;
  /// Inverse of angles_rad(), exact to rounding; |angle| < pi/4 without a lens.
  [[nodiscard]] Eigen::Vector2d aim_W_mm(const Eigen::Vector2d& angles_rad) const;
  /// d(angles)/d(aim), rad/mm.
  [[nodiscard]] Eigen::Matrix2d slopes_rad_mm(const Eigen::Vector2d& aim_W_mm) const;
  /// Aim that results if both mirrors go to their nearest steps and stay there while the beam marks.
  [[nodiscard]] Eigen::Vector2d nearestAim_W_mm(const Eigen::Vector2d& wanted_W_mm) const;
  /// Covariance of the aim by the rounding to whole steps, where nothing is known of the remainder: step²/12
  /// in each mirror, carried to the sheet. Zero without a step.
  [[nodiscard]] Eigen::Matrix2d roundingCovariance_mm2(const Eigen::Vector2d& aim_W_mm) const;
};

/// An f-theta lens as drawn: a beam at field angle t arrives at f t (1 + k1 t² + k2 t⁴) in its focal plane.
struct LensDesign {
  double focal_length_mm{};     ///< > 0.
  double k1_1_rad2{};           ///< Zero where the maker does not state it.
  double k2_1_rad4{};           ///< Zero where the maker does not state it.
  double incidence_ratio{0.5};  ///< Chief ray's angle at the sheet over the field angle: 0 telecentric.
};

/// The head as drawn: where a fit starts, and what tolerances are departures from.
struct HeadDesign {
  double throw_mm{};           ///< Last mirror's axis to the work plane; > 0.
  double mirror_spacing_mm{};  ///< Distance between the axes; >= 0.
  bool y_mirror_first{};       ///< The beam meets the Y mirror first.
  std::optional<LensDesign> lens;
};

/// @throws std::invalid_argument that names every field out of range.
void check(const NominalHead& nominal);
void check(const HeadDesign& design);

}  // namespace kerfbench::calibrate

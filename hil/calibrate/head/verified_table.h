// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/tables/aim_grid.h"

namespace kerfbench::calibrate {

/// Largest error of the beam anywhere in a field, with the controller's table at work. Errors of the mirrors'
/// rounding to whole steps are not in it: along the arms of a mark they average out.
struct LargestError {
  double value_mm{};
  double U_mm{};                                    ///< Expanded uncertainty, k = 2.
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};  ///< Place where it is most often the largest.
};

/// A table as the marks that verify it show it.
struct VerifiedTable {
  std::size_t marks{};
  /// Marks within the ellipse in which all other marks and the fit expect 95 % of them.
  std::size_t covered{};
  /// Marks that lie where neither the fit nor all others let expect a good one; each counts in `largest` with
  /// its own error, and says nothing of the head elsewhere.
  std::size_t disagreeing{};
  double tolerance_factor{1.0};  ///< Distance of the head from its drawing over what the fit states of it.
  double surface_factor{1.0};    ///< The same of what no departure describes, over what it was told of that.
  double mark_factor{1.0};       ///< Scatter of the marks over what is stated of it.
  LargestError largest;

  /// `covered` is what an ellipse of 95 % holds of so many, but for a chance of 1 %.
  [[nodiscard]] bool coverHolds() const;
};

/// Fewest and most of `count` independent places that an ellipse of 95 % holds: beyond lie 0.5 % on each side
/// (binomial distribution).
struct CoverBand {
  std::size_t least{}, most{};
};
CoverBand coverBand(std::size_t count);

/// Errors of a table over a field: what the fit does not know of the head, and what marks show that were cut
/// with this table and did not take part in the fit.
///
/// A fit states its errors by tolerances and data sheets; where these are wide of the head at hand, so is
/// what it states, and 400 marks that lie within a micrometre do not change that. So the fit's error modes
/// (HeadFit::errorModesAt(), independent of variance 1) are a prior, and the marks condition it:
///
///     measured - fitted = M m + t T t' + s S s' + Q q + n e
///
/// with M, T and S what the fitted marks' noise, the tolerances and the surface's prior make at the mark's
/// aim, Q q the error of its sheet's place, e its own noise as stated. The factors t, s and n are those of
/// the largest marginal likelihood (before the marks 1, to a factor of 10, 10 and 2, log-normal). Each mark
/// is held against what all others predict there (leave one out); distance² beyond what a good one of all
/// exceeds with a chance of 5 % makes it one that disagrees. Scatter of the marks beyond what is stated and
/// chance (1 %) counts as error of the beam from place to place. The largest error is that of 400 heads drawn
/// from the posterior, over a grid of 21 x 21 places, rim included: their mean, and twice their standard
/// deviation (JCGM 101).
///
/// Without marks it is what the fit alone says.
/// @throws HeadCalibrationError where the table does not reach, or the beam does not land.
VerifiedTable verifiedTable(const HeadFit& fit, const AimGrid& table, const Eigen::AlignedBox2d& field_W_mm,
                            std::span<const HeadObservation> marks);

}  // namespace kerfbench::calibrate

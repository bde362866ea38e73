// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/observation.h"

namespace kerfbench::calibrate {

/// Errors of marks against what is stated of them: covariance of the fit, of each mark, and of what the marks
/// of a sheet share.
struct StatedSpread {
  std::size_t marks{};    ///< Marks for which the fit states a covariance.
  std::size_t covered{};  ///< Marks among them within the ellipse that is stated to hold 95 %.
  /// Errors over what is stated, RMS over the marks and both axes; 1 is expected.
  double ratio{};
  /// Value that `ratio` exceeds with a chance of 1 % if all that is stated holds. Far above 1 where the marks
  /// are off together, as after a fit to few marks.
  double most_ratio{};
  /// The marks do not speak against what is stated.
  [[nodiscard]] bool holds() const { return ratio <= most_ratio; }
  /// "they are off 2.3 times as far as stated, where chance reaches 1.8"
  [[nodiscard]] std::string words() const;
};

/// Spread of marks that were not fitted. The mean of squared distances (Mahalanobis, of two degrees of
/// freedom each) is a weighted sum of chi-squares; its quantile is that of the one with the same mean and
/// variance (Satterthwaite 1946), the variance by all covariances between the marks.
StatedSpread statedSpread(const HeadFit& fit, std::span<const HeadObservation> marks);

}  // namespace kerfbench::calibrate

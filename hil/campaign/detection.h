// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace kerfbench::campaign {

/// A fault of a size that was put in, and whether it was found.
struct Trial {
  double size{};
  bool found{};
};

/// A size with its 95 % interval by profile likelihood; a bound is absent where the data give none.
struct SizeEstimate {
  double size{};
  std::optional<double> low, high;
  bool is_extrapolated{};  ///< Beyond the sizes that were tried the curve alone says so.
};

/// How likely a fault is found, over its size:
///
///     P(found) = 1 / (1 + exp(-(slope · (x - x50))))      x = ln(size), or the size itself
///
/// by maximum likelihood.
struct DetectionFit {
  double x50{}, slope{};  ///< In x; slope > 0.
  SizeEstimate half;      ///< Size that is found with a chance of 50 %.
  SizeEstimate most;      ///< Size that is found with a chance of 90 %.
  double deviance{};      ///< Twice the log likelihood that is lost against one chance for each size.
};

/// What the trials of one kind of fault tell.
struct Detection {
  std::size_t trials{}, found{};
  double smallest{}, largest{};  ///< Sizes that were tried; 0 without a trial.
  bool logarithmic{};  ///< x is ln(size): all sizes are above zero and span a factor of kLogarithmicFrom.
  std::optional<double> largest_missed;  ///< Absent: none was missed.
  std::optional<double> smallest_found;  ///< Absent: none was found.
  std::optional<DetectionFit> fit;
  std::string not_fitted;  ///< Why there is no fit; then the two sizes above are all that is known.

  /// The fitted chance at a size. Only with a fit.
  [[nodiscard]] double chanceAt(double size) const;
};

/// Sizes that span a factor of this are fitted over their logarithm.
inline constexpr double kLogarithmicFrom = 4.0;

/// Fits the curve. Trials whose sizes part the found from the missed, or that are all found or all missed,
/// or of one size, have no finite maximum of the likelihood (Albert and Anderson, Biometrika 71 (1984) 1):
/// they are not fitted.
Detection detectionOf(const std::vector<Trial>& trials);

}  // namespace kerfbench::campaign

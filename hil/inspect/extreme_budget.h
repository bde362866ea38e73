// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace kerfbench::hil {

/// One place of many, any of which may be the farthest off.
struct ExtremePoint {
  double likely{};            ///< Likely true deviation.
  double seen{};              ///< What the smoother makes of it.
  double sigma{};             ///< Standard uncertainty of the estimate by noise.
  double correlation{};       ///< Of the noise with that of the point before; 0 for the first of a run.
  Eigen::RowVectorXd shared;  ///< Shift of the deviation by one standard deviation of each shared error.
  int group{};                ///< The first `own` shared errors are common to the points of one group only.
};

/// Analytic uncertainty of max |deviation|.
struct ExtremeBudget {
  double extreme_bias{};    ///< Mean of the largest |seen + noise| less the largest |seen|.
  double smoothing_bias{};  ///< Largest |seen| less the largest |likely|.
  double u_noise{};         ///< Standard deviation of the largest |seen + noise|.
  double u_own{};  ///< By the shared errors of a group, through the chance of each place to be the largest.
  double u_common{};  ///< By the shared errors of all.
};

/// The distribution of the largest of correlated normal values: that no value lies above w is taken as a
/// Markov chain of neighbours,
///
///     P(max <= w) = prod over runs: Phi(z_1) · prod (1 - P(Z_i-1 <= z_i-1, Z_i > z_i) / Phi(z_i-1)),
///     P(Z1 <= a, Z2 > b) = Phi(a) - Phi(min(a, b))
///         + 1/(2 pi) · integral from 0 to acos r of exp(-(a² + b² - 2 a b cos t) / (2 sin² t)) dt,
///
/// exact for two normal values of correlation r; for a = b it is Rice's (1945) crossing rate.
ExtremeBudget extremeBudget(const std::vector<ExtremePoint>& points, Eigen::Index own);

}  // namespace kerfbench::hil

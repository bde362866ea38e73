// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hil/base/shares.h"

namespace kerfbench::gauge {

// Studies of a measuring instrument as pure functions of numbers. Lengths in any one unit.

using base::clopperPearson;
using base::Interval;

struct Moments {
  std::size_t count{};
  double mean{};
  double sigma{};  ///< Standard deviation of the sample, n - 1; NaN below two.
};
Moments momentsOf(const std::vector<double>& values);

/// The p-quantile, linear between order statistics (type 7); NaN of nothing.
double quantileOf(std::vector<double> values, double p);

/// An upper bound of the `share`-quantile of what the values are a sample of, with the given confidence and
/// without assuming a distribution (Wilks 1941): an order statistic. nullopt if there are too few values (59
/// for 95 % with 95 %).
std::optional<double> upperToleranceBound(std::vector<double> values, double share = 0.95,
                                          double confidence = 0.95);

/// Type-1 study: one artefact of known value measured again and again.
///
///     Cg = 0.2 T / (6 s)      Cgk = (0.1 T - |bias|) / (3 s)      (ISO 22514-7, VDA 5; both >= 1.33,
///     here 1.67)
struct TypeOne {
  Moments error;  ///< mean is the bias.
  double cg{};
  double cgk{};
};
/// @param errors     measured less true, at least two.
/// @param tolerance  T, the width of the tolerance.
TypeOne typeOne(const std::vector<double>& errors, double tolerance);

/// Gauge repeatability and reproducibility by analysis of variance, crossed, with interaction (AIAG MSA, 4th
/// ed., appendix A): parts x placements x repeats, a placement in the appraiser's role. Variances that come
/// out negative are zero; an interaction that is not significant is not pooled, as the two answers differ by
/// less than either is known.
struct Grr {
  double repeatability{};         ///< EV; this and the next three are standard deviations.
  double reproducibility{};       ///< AV: placement, and its interaction with the part.
  double grr{};                   ///< Repeatability and reproducibility together.
  double part{};                  ///< PV
  double percent_of_tolerance{};  ///< 100 · 6 GRR / T
  double percent_of_study{};      ///< 100 · GRR / TV
  double ndc{};                   ///< 1.41 PV / GRR, the number of distinct categories.
};
/// @param values  value of part i, placement j, repeat k at (i · placements + j) · repeats + k.
/// @throws std::invalid_argument unless there are at least two of each, and as many values as that makes.
Grr anovaGrr(const std::vector<double>& values, std::size_t parts, std::size_t placements,
             std::size_t repeats, double tolerance);

/// Bias over size: error = offset + slope · truth, by least squares.
struct Linearity {
  double offset{};
  double slope{};
  double slope_sigma{};  ///< Standard uncertainty of the slope.
  double scatter{};      ///< About the line, standard deviation.
};
Linearity linearityOf(const std::vector<double>& truth, const std::vector<double>& error);

}  // namespace kerfbench::gauge

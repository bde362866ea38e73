// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace kerfbench::inspect {

/// A measured value with its expanded uncertainty U (k = 2, 95.45 %): the truth lies in value ± U.
struct Quantity {
  double value{std::numeric_limits<double>::quiet_NaN()};
  double U{std::numeric_limits<double>::quiet_NaN()};
};

/// One line of an uncertainty budget (JCGM 100).
struct BudgetEntry {
  std::string source;   ///< In plain words.
  double u{};           ///< Standard uncertainty that it adds, in the quantity's unit.
  double correction{};  ///< What was subtracted from the value because of it.
};

/// How well a verdict quantity is known, found in two ways.
struct UncertaintyBudget {
  std::string quantity;  ///< "worst deviation of all lines"
  std::string unit;      ///< "mm"
  double as_read{};      ///< Before corrections.
  std::vector<BudgetEntry> entries;
  double analytic_U{};         ///< 2 x root sum of squares of the entries (JCGM 100), cut off at nought.
  double analytic_value{};     ///< as_read less the corrections.
  double monte_carlo_U{};      ///< Twice the standard deviation of simulated measurements (JCGM 101).
  double monte_carlo_value{};  ///< The reading, corrected by their mean.
  int draws{};
};

/// Value and U of what was read as `as_read`, from simulated measurements of a known truth: what they differ
/// from it by is what the real one may differ by. Their mean is the correction, twice their standard
/// deviation U (JCGM 101, 7.6); quantiles of some hundred draws would scatter twice as much. Truths below
/// `least` are impossible (a magnitude: 0).
Quantity basicInterval(double as_read, double simulated_truth, const std::vector<double>& simulated,
                       double least = -std::numeric_limits<double>::infinity());

/// Chance that the truth lies above the limit, from the same simulations, smoothed so that it is told even
/// where none of them went.
double chanceAbove(double limit, double as_read, double simulated_truth,
                   const std::vector<double>& simulated);

/// The same for a truth that is normal about `value` with the standard uncertainty U / 2.
double chanceAboveNormal(double limit, const Quantity& quantity);

}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace kerfbench::base {

/// From `low` to `high`, both belong to it.
struct Interval {
  double low{};
  double high{};
};

/// P(X <= k) of a binomial variable: k successes or fewer in n trials of chance p in [0, 1].
double binomialCdf(std::size_t k, std::size_t n, double p);

/// Exact two-sided confidence interval of a share of which `hits` of `trials` were seen (Clopper and Pearson
/// 1934). trials > 0, hits <= trials, confidence in (0, 1).
Interval clopperPearson(std::size_t hits, std::size_t trials, double confidence = 0.95);

}  // namespace kerfbench::base

// SPDX-License-Identifier: Apache-2.0
#include "hil/base/shares.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::base {
namespace {

/// Where a function that falls from 1 to 0 over [0, 1] passes a level.
template <typename Function>
double fallsTo(double level, const Function& f) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double p = 0.5 * (low + high);
    (f(p) > level ? low : high) = p;
  }
  return 0.5 * (low + high);
}

}  // namespace

double binomialCdf(std::size_t k, std::size_t n, double p) {
  if (k >= n || p <= 0.0) return 1.0;
  if (p >= 1.0) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i <= k; ++i) {
    const auto x = static_cast<double>(i);
    const auto m = static_cast<double>(n);
    sum += std::exp(std::lgamma(m + 1.0) - std::lgamma(x + 1.0) - std::lgamma(m - x + 1.0) + x * std::log(p) +
                    (m - x) * std::log1p(-p));
  }
  return std::min(sum, 1.0);
}

Interval clopperPearson(std::size_t hits, std::size_t trials, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  Interval interval{0.0, 1.0};
  if (hits < trials) interval.high = fallsTo(tail, [&](double p) { return binomialCdf(hits, trials, p); });
  if (hits > 0)
    interval.low = fallsTo(1.0 - tail, [&](double p) { return binomialCdf(hits - 1, trials, p); });
  return interval;
}

}  // namespace kerfbench::base

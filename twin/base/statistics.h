// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace kerfbench {

/// Standard deviation of a normal law over its median absolute deviation (Hampel 1974): 1 / 0.6745, where
/// 0.6745 is the quantile of 0.75 of the standard normal law.
inline constexpr double kMadToSigma = 1.4826;

/// Median of the square of a standard normal value: 0.6745².
inline constexpr double kMedianSquare = 0.4549;

/// Median: the mean of the middle two of an even number, NaN of no values.
inline double medianOf(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/// Upper median: of an even number the larger one of the middle two, so one of the values itself. `values`
/// must not be empty, and are left in another order.
template <class Value>
Value upperMedianIn(std::vector<Value>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Upper median of values that are left as they are; they must not be empty.
template <class Value>
Value upperMedianOf(std::vector<Value> values) {
  return upperMedianIn(values);
}

}  // namespace kerfbench

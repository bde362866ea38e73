// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace kerfbench::vision {

// Private to this room: what is read off histograms of gray and of steps between neighbours.

/// The least level that more than this share of the counts lies at or below.
template <std::size_t Bins>
int quantile(const std::array<int, Bins>& histogram, double share) {
  long long total = 0;
  for (const int n : histogram) total += n;
  long long seen = 0;
  for (std::size_t i = 0; i < Bins; ++i) {
    seen += histogram[i];
    if (static_cast<double>(seen) > share * static_cast<double>(total)) return static_cast<int>(i);
  }
  return static_cast<int>(Bins) - 1;
}

/// Standard deviation of a pixel by the steps to its neighbours. Edges of marks and kerfs make a few big
/// steps: they are left out.
inline double noiseBySteps(const std::array<int, 256>& steps) {
  const int typical = std::max(1, quantile(steps, 0.5));
  double sum = 0.0;
  long long count = 0;
  for (int d = 0; d <= 6 * typical && d < 256; ++d) {
    const int n = steps[static_cast<std::size_t>(d)];
    sum += static_cast<double>(n) * d * d;
    count += n;
  }
  return std::max(0.3, std::sqrt(sum / static_cast<double>(std::max(1LL, count)) / 2.0));
}

/// True if hardly any neighbours differ.
inline bool withoutSteps(const std::array<int, 256>& steps, long long total) {
  long long some = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) some += steps[i];
  return some * 1000 < total;
}

}  // namespace kerfbench::vision

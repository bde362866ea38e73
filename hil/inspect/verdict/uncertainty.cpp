// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/verdict/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::inspect {
namespace {

double normalTail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

}  // namespace

Quantity basicInterval(double as_read, double simulated_truth, const std::vector<double>& simulated,
                       double least) {
  const bool usable =
      !simulated.empty() && std::isfinite(as_read) && std::isfinite(simulated_truth) &&
      std::all_of(simulated.begin(), simulated.end(), [](double v) { return std::isfinite(v); });
  if (!usable) return {};
  const auto n = static_cast<double>(simulated.size());
  double mean = 0.0;
  for (const double v : simulated) mean += v / n;
  double variance = 0.0;
  for (const double v : simulated) variance += (v - mean) * (v - mean) / n;
  const double middle = as_read - (mean - simulated_truth);
  const double low = std::max(middle - 2.0 * std::sqrt(variance), least);
  const double high = std::max(middle + 2.0 * std::sqrt(variance), low);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

double chanceAbove(double limit, double as_read, double simulated_truth,
                   const std::vector<double>& simulated) {
  const auto n = static_cast<double>(simulated.size());
  double mean = 0.0;
  for (const double s : simulated) mean += (as_read - (s - simulated_truth)) / n;
  double variance = 0.0;
  for (const double s : simulated) variance += std::pow(as_read - (s - simulated_truth) - mean, 2) / n;
  if (!(variance > 0.0)) return mean > limit ? 1.0 : 0.0;
  // Each draw spread out by a normal kernel, and drawn in so that the variance stays (Silverman 1986, 6.4).
  const double sigma = std::sqrt(variance);
  const double kernel = std::min(1.06 * std::pow(n, -0.2), 0.9) * sigma;
  const double shrink = std::sqrt(1.0 - kernel * kernel / variance);
  double chance = 0.0;
  for (const double s : simulated) {
    const double truth = mean + shrink * (as_read - (s - simulated_truth) - mean);
    chance += normalTail((limit - truth) / kernel) / n;
  }
  return chance;
}

double chanceAboveNormal(double limit, const Quantity& quantity) {
  if (!(quantity.U > 0.0)) return quantity.value > limit ? 1.0 : 0.0;
  return normalTail(2.0 * (limit - quantity.value) / quantity.U);
}

}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::planner {
namespace {

/// Limits the power; NaN becomes the least.
double within(double power_w, const PowerLimits& limits) {
  return power_w > limits.least_w ? std::min(power_w, limits.most_w) : limits.least_w;
}

}  // namespace

double nextPower(double power_w, double wanted_w, double measured_w, const PowerLimits& limits, double gain) {
  const double target_w = within(wanted_w, limits);
  if (!std::isfinite(measured_w) || measured_w < 0.0 || !std::isfinite(power_w)) return target_w;
  return within(within(power_w, limits) + gain * (target_w - measured_w), limits);
}

double dampedGain(int late_periods) {
  return 0.8 * std::sin(std::numbers::pi / (2.0 * (2.0 * late_periods + 1.0)));
}

std::vector<double> loopCourse(const std::vector<double>& wanted_w, double tube, int late_periods,
                               double gain, LoopLaw law, const PowerLimits& limits) {
  const auto late = static_cast<std::size_t>(late_periods);
  std::vector<double> measured_w;
  std::vector<double> shares;
  double power_w = wanted_w.empty() ? 0.0 : wanted_w.front();
  double trim = 1.0;
  for (std::size_t k = 0; k < wanted_w.size(); ++k) {
    measured_w.push_back(tube * power_w);
    shares.push_back(measured_w.back() / wanted_w[k]);
    if (k + 1 == wanted_w.size()) break;
    const double next_w = wanted_w[k + 1];
    if (law == LoopLaw::kShares) {
      if (k >= late) trim += gain * (1.0 - measured_w[k - late] / wanted_w[k - late]);
      power_w = within(trim * next_w, limits);
    } else {
      power_w += next_w - wanted_w[k];
      if (k >= late) power_w = nextPower(power_w, wanted_w[k - late], measured_w[k - late], limits, gain);
    }
  }
  return shares;
}

}  // namespace kerfbench::planner

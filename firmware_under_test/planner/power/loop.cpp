// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/loop.h"

#include <algorithm>
#include <cmath>

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

}  // namespace kerfbench::planner

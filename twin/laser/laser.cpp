// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/laser.h"

#include <cmath>

namespace kerfbench::twin {

double Laser::step(double demand, double step_s) {
  const double target_w = demand * description_.full_power_w;
  const double tau_s = description_.rise_time_s;
  if (tau_s <= 0) {
    power_w_ = target_w;
    return target_w * step_s;
  }
  // Exact for a demand that is constant over the step.
  const double decay = std::exp(-step_s / tau_s);
  const double energy_j = target_w * step_s + (power_w_ - target_w) * tau_s * (1.0 - decay);
  power_w_ = target_w + (power_w_ - target_w) * decay;
  constexpr double kDark = 1e-6;
  if (demand == 0.0 && power_w_ < kDark * description_.full_power_w) power_w_ = 0.0;
  return energy_j;
}

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include "twin/five_axis/five_axis_description.h"

#include <fmt/format.h>

namespace kerfbench::twin {

std::string faultsOf(const FiveAxisDescription& head) {
  std::string faults;
  const auto within = [&](const char* name, double value, double least, double most) {
    // Written so that a value that is no number is refused.
    if (value >= least && value <= most) return;
    faults +=
        fmt::format("{}{} is {}, not in {:g} … {:g}", faults.empty() ? "" : "; ", name, value, least, most);
  };
  within("pivot_mm", head.pivot_mm, 1.0, 2000.0);
  within("linear_step_mm", head.linear_step_mm, 1e-6, 1.0);
  within("turn_step_rad", head.turn_step_rad, 1e-9, 0.1);
  within("feed_mm_s", head.feed_mm_s, 0.1, 1e4);
  within("power_w", head.power_w, 0.01, 1e5);
  within("waist_radius_mm", head.waist_radius_mm, 0.031, 2.0);
  within("rayleigh_mm", head.rayleigh_mm, 0.1, 1e4);
  within("turn_speed_rad_s", head.turn_speed_rad_s, 0.01, 100.0);
  within("errors.pivot_mm", head.errors.pivot_mm, -5.0, 5.0);
  within("errors.a_zero_rad", head.errors.a_zero_rad, -0.1, 0.1);
  within("errors.c_zero_rad", head.errors.c_zero_rad, -0.1, 0.1);
  within("errors.a_backlash_rad", head.errors.a_backlash_rad, 0.0, 0.1);
  within("errors.c_backlash_rad", head.errors.c_backlash_rad, 0.0, 0.1);
  within("errors.squareness_rad", head.errors.squareness_rad, -0.1, 0.1);
  return faults;
}

}  // namespace kerfbench::twin

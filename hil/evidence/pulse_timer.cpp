// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/pulse_timer.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace kerfbench::evidence {
namespace {

constexpr std::size_t kSetupBins = 61;  // 0 … 30 us in steps of half a microsecond, and everything longer.

// A day of seconds in a double is exact to 1.5e-11 s: a time that equals the limit violates nothing.
constexpr double kRounding_s = 1e-10;

// DIR that has never changed has no set-up time.
constexpr double kNeverBefore_s = -1e8;

}  // namespace

// Lines are low at first. A drive that steps on the falling edge finds its active level then, without an
// edge.
PulseTimer::PulseTimer(std::string axis, const DriverProfile& profile, bool has_enable)
    : active_(!profile.active_edge_rising), enabled_(!has_enable || profile.enabledBy(false)) {
  constexpr double kNothingSeen = std::numeric_limits<double>::infinity();
  timing_.axis = std::move(axis);
  timing_.profile = profile;
  timing_.has_enable = has_enable;
  timing_.min_setup_s = timing_.min_hold_s = timing_.min_width_s = timing_.min_space_s = kNothingSeen;
  timing_.setup_histogram.assign(kSetupBins, 0);
}

void PulseTimer::countViolation(std::uint64_t& counter, double time_s) {
  ++counter;
  if (timing_.first_violation_s < 0) timing_.first_violation_s = time_s;
}

// The first change after an enable is the one that comes soonest.
void PulseTimer::sinceEnable(double time_s) {
  if (!enable_s_) return;
  const double enable_setup_s = time_s - *enable_s_;
  enable_s_.reset();
  timing_.min_enable_setup_s = std::min(timing_.min_enable_setup_s, enable_setup_s);
  if (enable_setup_s < timing_.profile.enable_setup_s - kRounding_s)
    countViolation(timing_.enable_setup_violations, time_s);
}

void PulseTimer::enableLevel(double time_s, bool level) {
  const bool enabled = timing_.profile.enabledBy(level);
  if (enabled == enabled_) return;
  enabled_ = enabled;
  enable_s_ = enabled ? std::optional(time_s) : std::nullopt;
}

void PulseTimer::activeEdge(double time_s) {
  const double space_s = time_s - idle_edge_s_;
  if (timing_.pulses > 0) timing_.min_space_s = std::min(timing_.min_space_s, space_s);
  ++timing_.pulses;
  if (!enabled_) countViolation(timing_.disabled_pulses, time_s);
  sinceEnable(time_s);
  const double setup_s = time_s - dir_edge_s_;
  if (dir_edge_s_ > kNeverBefore_s) timing_.min_setup_s = std::min(timing_.min_setup_s, setup_s);
  const double last_bin = static_cast<double>(kSetupBins - 1);
  ++timing_.setup_histogram[static_cast<std::size_t>(std::min(setup_s / timing_.setup_bin_s, last_bin))];
  if (setup_s < timing_.profile.setup_s - kRounding_s) countViolation(timing_.setup_violations, time_s);
  if (space_s < timing_.profile.space_s - kRounding_s) countViolation(timing_.space_violations, time_s);
  active_edge_s_ = time_s;
}

void PulseTimer::idleEdge(double time_s) {
  idle_edge_s_ = time_s;
  if (timing_.pulses == 0) return;  // The level that the line had from the start was no pulse.
  const double width_s = time_s - active_edge_s_;
  timing_.min_width_s = std::min(timing_.min_width_s, width_s);
  if (width_s < timing_.profile.width_s - kRounding_s) countViolation(timing_.width_violations, time_s);
}

void PulseTimer::directionChange(double time_s) {
  dir_edge_s_ = time_s;
  sinceEnable(time_s);
  if (timing_.pulses == 0) return;
  const double hold_s = time_s - active_edge_s_;
  timing_.min_hold_s = std::min(timing_.min_hold_s, hold_s);
  if (hold_s < timing_.profile.hold_s - kRounding_s) countViolation(timing_.hold_violations, time_s);
}

void PulseTimer::levels(double time_s, bool pul, bool dir) {
  const bool active = pul == timing_.profile.active_edge_rising;
  // DIR first: where one port write changes both, DIR has no set-up time at all.
  if (dir != dir_) {
    dir_ = dir;
    directionChange(time_s);
  }
  if (active == active_) return;
  active_ = active;
  if (active) {
    activeEdge(time_s);
  } else {
    idleEdge(time_s);
  }
}

}  // namespace kerfbench::evidence

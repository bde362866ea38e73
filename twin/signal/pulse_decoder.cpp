// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/pulse_decoder.h"

#include <utility>

namespace kerfbench::twin {
namespace {
// Ticks are rounded to doubles, which after a day are 1.5e-11 s apart; a time that is exactly the limit is no
// violation.
constexpr double kRounding_s = 1e-10;
}  // namespace

// Pins are low at first: a drive with a falling active edge then sees its active level without an edge.
PulseDecoder::PulseDecoder(DriverProfile profile, bool has_enable)
    : profile_(std::move(profile)),
      active_(!profile_.active_edge_rising),
      enabled_(!has_enable || profile_.enabledBy(false)) {}

void PulseDecoder::activeEdge(double time_s) {
  // A late DIR has not reached the latch: the drive steps in the old direction.
  const bool latched = time_s - dir_s_ >= profile_.setup_s - kRounding_s;
  edge_s_ = time_s;
  // A pause that is too short joins the two pulses to one.
  if (time_s - idle_s_ < profile_.space_s - kRounding_s) return;
  if (!enabled_ || time_s - enable_s_ < profile_.enable_setup_s - kRounding_s) return;
  pending_ = true;
  pending_direction_ = profile_.senseOf(latched ? dir_ : old_dir_);
}

void PulseDecoder::idleEdge(double time_s) {
  idle_s_ = time_s;
  pending_ = false;
}

void PulseDecoder::enableLevel(double time_s, bool level, std::vector<StepEdge>& steps) {
  settle(time_s, steps);
  const bool enabled = profile_.enabledBy(level);
  if (enabled == enabled_) return;
  enabled_ = enabled;
  if (enabled) enable_s_ = time_s;
  pending_ = false;
}

void PulseDecoder::settle(double time_s, std::vector<StepEdge>& steps) {
  if (!pending_ || time_s < edge_s_ + profile_.width_s - kRounding_s) return;
  steps.push_back({edge_s_ + profile_.width_s, pending_direction_});
  pending_ = false;
}

void PulseDecoder::levels(double time_s, bool pul, bool dir, std::vector<StepEdge>& steps) {
  settle(time_s, steps);
  const bool active = pul == profile_.active_edge_rising;
  // A DIR that changes in the same port write as PUL has no set-up time at all.
  if (dir != dir_) {
    // A level that did not stand for the set-up time never reached the latch.
    if (time_s - dir_s_ >= profile_.setup_s - kRounding_s) old_dir_ = dir_;
    dir_ = dir;
    dir_s_ = time_s;
  }
  if (active && !active_) activeEdge(time_s);
  if (!active && active_) idleEdge(time_s);
  active_ = active;
}

}  // namespace kerfbench::twin

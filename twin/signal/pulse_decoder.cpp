// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/pulse_decoder.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace kerfbench::twin {
namespace {
constexpr std::size_t kHistogramBins = 61;  // 0 … 30 us and beyond.
// Ticks are rounded to doubles, which after a day are 1.5e-11 s apart; a time that is exactly the limit is no
// violation.
constexpr double kRounding_s = 1e-10;
}  // namespace

// Pins are low at first: a drive with a falling active edge then sees its active level without an edge.
PulseDecoder::PulseDecoder(std::string axis, const DriverProfile& profile)
    : active_(!profile.active_edge_rising) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  timing_.axis = std::move(axis);
  timing_.profile = profile;
  timing_.min_setup_s = timing_.min_hold_s = timing_.min_width_s = timing_.min_space_s = kNever;
  timing_.setup_histogram.assign(kHistogramBins, 0);
}

void PulseDecoder::violation(std::uint64_t& counter, double time_s) {
  ++counter;
  if (timing_.first_violation_s < 0) timing_.first_violation_s = time_s;
}

void PulseDecoder::activeEdge(double time_s) {
  const double space_s = time_s - idle_s_;
  if (timing_.pulses > 0) timing_.min_space_s = std::min(timing_.min_space_s, space_s);
  ++timing_.pulses;
  const double setup_s = time_s - dir_s_;
  if (dir_s_ > -1e8) timing_.min_setup_s = std::min(timing_.min_setup_s, setup_s);
  const auto bin = static_cast<std::size_t>(
      std::min(setup_s / timing_.setup_bin_s, static_cast<double>(kHistogramBins - 1)));
  ++timing_.setup_histogram[bin];
  bool seen_dir = dir_;
  if (setup_s < timing_.profile.setup_s - kRounding_s) {
    violation(timing_.setup_violations, time_s);
    seen_dir = old_dir_;
  }
  edge_s_ = time_s;
  if (space_s < timing_.profile.space_s - kRounding_s) {
    violation(timing_.space_violations, time_s);
    return;  // To the drive the two pulses are one.
  }
  pending_ = true;
  pending_direction_ = seen_dir ? 1 : -1;
}

void PulseDecoder::idleEdge(double time_s) {
  idle_s_ = time_s;
  if (timing_.pulses == 0) return;  // The level that the pin had from the start was no pulse.
  const double width_s = time_s - edge_s_;
  timing_.min_width_s = std::min(timing_.min_width_s, width_s);
  if (width_s < timing_.profile.width_s - kRounding_s) violation(timing_.width_violations, time_s);
  pending_ = false;
}

void PulseDecoder::settle(double time_s, std::vector<StepEdge>& steps) {
  if (!pending_ || time_s < edge_s_ + timing_.profile.width_s - kRounding_s) return;
  steps.push_back({edge_s_ + timing_.profile.width_s, pending_direction_});
  pending_ = false;
}

void PulseDecoder::levels(double time_s, bool pul, bool dir, std::vector<StepEdge>& steps) {
  settle(time_s, steps);
  const bool active = pul == timing_.profile.active_edge_rising;
  // Both in one port write: DIR has then no set-up time at all.
  if (dir != dir_) {
    const double hold_s = time_s - edge_s_;
    if (timing_.pulses > 0) {
      timing_.min_hold_s = std::min(timing_.min_hold_s, hold_s);
      if (hold_s < timing_.profile.hold_s - kRounding_s) violation(timing_.hold_violations, time_s);
    }
    // A level that did not stand for the set-up time never reached the latch.
    if (time_s - dir_s_ >= timing_.profile.setup_s - kRounding_s) old_dir_ = dir_;
    dir_ = dir;
    dir_s_ = time_s;
  }
  if (active && !active_) activeEdge(time_s);
  if (!active && active_) idleEdge(time_s);
  active_ = active;
}

}  // namespace kerfbench::twin

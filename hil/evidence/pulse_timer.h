// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "twin/base/pulse_timing.h"

namespace kerfbench::evidence {

/// Measures a pair of PUL and DIR lines against the times that the drive's data sheet asks for: set-up and
/// hold of DIR, width and space of PUL, and from its enable to the first of both. It counts and measures;
/// what the drive makes of the pulses is not its business. Times in s on the clock of the pins, never running
/// backwards; all lines are low before the first call.
class PulseTimer {
 public:
  /// `axis`: the name in reports, for example "galvo_x".
  /// `has_enable`: the drive has an enable line. Without one it is always enabled.
  PulseTimer(std::string axis, const DriverProfile& profile, bool has_enable = false);

  /// The level of the enable line from this time on; before levels() of the same time.
  void enableLevel(double time_s, bool level);

  /// The levels of PUL and DIR from this time on.
  void levels(double time_s, bool pul, bool dir);

  [[nodiscard]] const PulseTiming& timing() const { return timing_; }

 private:
  void activeEdge(double time_s);
  void idleEdge(double time_s);
  void directionChange(double time_s);
  void sinceEnable(double time_s);
  void countViolation(std::uint64_t& counter, double time_s);

  PulseTiming timing_;
  bool active_;  ///< PUL is at its active level.
  bool enabled_;
  bool dir_{false};
  std::optional<double> enable_s_;  ///< Time at which it was enabled, until PUL or DIR change.
  double active_edge_s_{-1e9};
  double idle_edge_s_{-1e9};
  double dir_edge_s_{-1e9};
};

}  // namespace kerfbench::evidence

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"
#include "twin/description/description.h"

namespace kerfbench::twin {

/// Power meter behind a mirror: its pin toggles for each quantum of energy that the laser has emitted, as the
/// meter reads it (`scale`), after `delay_s`. The delay is longer than a quantum of the lockstep, so future
/// edges are known and do not depend on the length of the quanta.
class PowerMonitor {
 public:
  PowerMonitor(TickRate rate, const PowerMonitorDescription& monitor) : rate_(rate), monitor_(monitor) {}

  /// Adds `energy_j`, emitted evenly from `begin_s` on during `step_s`. Times must follow each other.
  void emitted(double energy_j, double begin_s, double step_s);
  /// States that the edges of all later energy will be asked for.
  void connect() { sends_ = true; }
  /// Appends the edges up to `until` that were not sent yet; an edge that is due before `now` comes at now +
  /// 1. Exact as long as all energy up to until - delay_s is known.
  void predict(Tick now, Tick until, std::vector<SensorEdge>& edges);

 private:
  TickRate rate_;
  PowerMonitorDescription monitor_;
  double read_j_{0.0};        ///< All energy so far as the meter reads it.
  double quanta_{0.0};        ///< Whole quanta in read_j_.
  std::deque<double> due_s_;  ///< Times of edges that were not sent yet.
  bool level_{false};         ///< Level of the pin as sent.
  bool sends_{false};
};

}  // namespace kerfbench::twin

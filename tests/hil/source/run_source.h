// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "hil/source/open.h"

namespace kerfbench::source {

/// Record of a run.
struct Run {
  Stop stop{};
  std::vector<PinEvent> events;
  std::string uart;
  std::string message;
};

/// Runs in lockstep; `before` may drive inputs for the quantum that ends at its argument.
inline Run runSource(SignalSource& source, Tick until, Tick quantum,
                     const std::function<void(Tick)>& before = {}) {
  Run run;
  Batch batch;
  for (Tick tick = 0; tick < until && run.stop == Stop::kReached;) {
    tick = std::min(until, tick + quantum);
    if (before) before(tick);
    run.stop = source.advance(tick, batch);
    run.events.insert(run.events.end(), batch.events.begin(), batch.events.end());
    run.uart.append(batch.uart.begin(), batch.uart.end());
  }
  run.message = source.message();
  return run;
}

/// Ticks at which one pin rises (or falls).
inline std::vector<Tick> edgesOf(const std::vector<PinEvent>& events, PinId pin, bool rising = true) {
  std::vector<Tick> ticks;
  for (const auto& event : events) {
    if (event.port != pin.port || (event.changed >> pin.bit & 1) == 0) continue;
    if (((event.level >> pin.bit & 1) != 0) == rising) ticks.push_back(event.tick);
  }
  return ticks;
}

}  // namespace kerfbench::source

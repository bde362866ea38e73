// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/power_monitor.h"

#include <algorithm>

namespace kerfbench::twin {

void PowerMonitor::emitted(double energy_j, double begin_s, double step_s) {
  if (energy_j <= 0.0) return;
  const double before_j = read_j_;
  read_j_ += energy_j * monitor_.scale;
  for (;;) {
    const double next_j = (quanta_ + 1.0) * monitor_.quantum_j;
    if (read_j_ < next_j) return;
    quanta_ += 1.0;
    const double share = std::clamp((next_j - before_j) / (read_j_ - before_j), 0.0, 1.0);
    if (sends_) due_s_.push_back(begin_s + share * step_s + monitor_.delay_s);
  }
}

void PowerMonitor::predict(Tick now, Tick until, std::vector<SensorEdge>& edges) {
  while (!due_s_.empty()) {
    const Tick tick = std::max(rate_.ticksAt(due_s_.front()) + 1, now + 1);
    if (tick > until) return;
    due_s_.pop_front();
    level_ = !level_;
    edges.push_back({tick, Signal::kPowerMonitor, level_});
  }
}

}  // namespace kerfbench::twin

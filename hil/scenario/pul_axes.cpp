// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/pul_axes.h"

namespace kerfbench::scenario {

std::array<std::pair<Signal, const twin::AxisDescription*>, 5> pulAxes(
    const twin::MachineDescription& machine) {
  return {{{Signal::kGalvoXPul, &machine.galvo_x},
           {Signal::kGalvoYPul, &machine.galvo_y},
           {Signal::kGantryXPul, &machine.gantry_x},
           {Signal::kGantryYPul, &machine.gantry_y},
           {Signal::kFeedPul, &machine.belt.feed}}};
}

source::StartLevels startLevels(const twin::MachineDescription& machine) {
  source::StartLevels levels;
  for (const auto& [signal, axis] : pulAxes(machine)) {
    if (axis->profile.active_edge_rising) levels.low.push_back(signal);
  }
  if (machine.laser.gate_low) levels.high.push_back(Signal::kLaserGate);
  return levels;
}

}  // namespace kerfbench::scenario

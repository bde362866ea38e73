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

std::vector<Signal> countedRising(const twin::MachineDescription& machine) {
  std::vector<Signal> rising;
  for (const auto& [signal, axis] : pulAxes(machine)) {
    if (axis->profile.active_edge_rising) rising.push_back(signal);
  }
  return rising;
}

}  // namespace kerfbench::scenario

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

std::vector<Signal> spareOutputs(const twin::MachineDescription& machine, bool belt_by_controller) {
  const bool gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
  std::vector<Signal> puls = gantry ? std::vector{Signal::kGalvoXPul, Signal::kGalvoYPul}
                                    : std::vector{Signal::kGantryXPul, Signal::kGantryYPul};
  if (!belt_by_controller) puls.push_back(Signal::kFeedPul);
  std::vector<Signal> spare;
  for (const Signal pul : puls) {
    const auto dir = static_cast<Signal>(static_cast<std::size_t>(pul) + 1);
    spare.insert(spare.end(), {pul, dir, enableOf(pul)});
  }
  return spare;
}

}  // namespace kerfbench::scenario

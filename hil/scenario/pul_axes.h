// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "hil/source/pin_capture.h"
#include "twin/base/signal_map.h"
#include "twin/description/description.h"

namespace kerfbench::scenario {

/// PUL of each axis that a machine can have, with its axis; for machines without one it says nothing.
std::array<std::pair<Signal, const twin::AxisDescription*>, 5> pulAxes(
    const twin::MachineDescription& machine);
/// Levels that a machine's lines must have before the first edge: PULs of drives that count rising edges are
/// low, and a gate that is active while low is high.
source::StartLevels startLevels(const twin::MachineDescription& machine);
/// Controller's outputs of axes that the machine has not: those of the other kind of head, and of the feed
/// unless it moves the belt. A board's pin list may have them all the same.
std::vector<Signal> spareOutputs(const twin::MachineDescription& machine, bool belt_by_controller);

}  // namespace kerfbench::scenario

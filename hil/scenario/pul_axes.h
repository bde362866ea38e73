// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "twin/base/signal_map.h"
#include "twin/description/description.h"

namespace kerfbench::scenario {

/// PUL of each axis that a machine can have, with its axis; for machines without one it says nothing.
std::array<std::pair<Signal, const twin::AxisDescription*>, 5> pulAxes(
    const twin::MachineDescription& machine);
/// PUL of the drives that count its rising edges.
std::vector<Signal> countedRising(const twin::MachineDescription& machine);
}  // namespace kerfbench::scenario

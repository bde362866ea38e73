// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/source/gpio/chip_lines.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// Line of a chip that carries a signal.
struct GpioWire {
  Signal signal{};
  std::uint32_t offset{};
};

/// Lines of a chip for these wires. @throws std::invalid_argument if one is for a signal that
/// `map` does not have, or that is no sensor (`sensors`) or one (not `sensors`).
std::vector<ChipLine> chipLinesOf(const std::vector<GpioWire>& wires, const SignalMap& map, bool sensors);
/// The pins of these wires, as `map` has them.
std::vector<PinId> pinsOf(const std::vector<GpioWire>& wires, const SignalMap& map);

}  // namespace kerfbench::source

// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/wires.h"

#include <stdexcept>
#include <string>

namespace kerfbench::source {

std::vector<ChipLine> chipLinesOf(const std::vector<GpioWire>& wires, const SignalMap& map, bool sensors) {
  std::vector<ChipLine> lines;
  for (const GpioWire& wire : wires) {
    if (!map.pin(wire.signal) || isSensor(wire.signal) != sensors)
      throw std::invalid_argument("a wire for a signal that the machine does not have this way");
    lines.push_back({wire.offset, std::string(signalName(wire.signal))});
  }
  return lines;
}

std::vector<PinId> pinsOf(const std::vector<GpioWire>& wires, const SignalMap& map) {
  std::vector<PinId> pins;
  for (const GpioWire& wire : wires) pins.push_back(map.pin(wire.signal).value());
  return pins;
}

}  // namespace kerfbench::source

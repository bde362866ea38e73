// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "twin/base/pin_event.h"

namespace kerfbench::evidence {

// Private to this room.

/// The levels of all ports as writes to them arrive; low at first.
class PortLevels {
 public:
  void apply(const PinEvent& event) {
    if (event.port >= levels_.size()) levels_.resize(std::size_t{event.port} + 1, 0);
    levels_[event.port] = event.level;
  }
  [[nodiscard]] bool high(PinId pin) const {
    return pin.port < levels_.size() && ((levels_[pin.port] >> pin.bit) & 1U) != 0;
  }

 private:
  std::vector<std::uint16_t> levels_;
};

}  // namespace kerfbench::evidence

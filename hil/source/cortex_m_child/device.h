// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "hil/source/cortex_m_child/memory_map.h"

namespace kerfbench::cortex_m_child {

/// A device with registers of 32 bits. Whoever calls it has brought it to the present before.
class Device {
 public:
  Device() = default;
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
  /// Puts the registers back to what they are after a reset of the system.
  virtual void reset() = 0;
  /// Cycle at which the device next does something that others notice.
  [[nodiscard]] virtual Cycle nextEvent() const { return kNever; }
  /// Brings the device to a cycle that is not after its next event.
  virtual void runTo(Cycle /*cycle*/) {}
  /// A channel of the DMA has been switched on: whoever waits for it may ask again.
  virtual void serveDma() {}
};

/// What devices share: the present, and the words that end a run.
struct Present {
  Cycle cycle{};
  std::string failure;   ///< Why the run cannot go on; empty while it can.
  std::string misheard;  ///< Firmware and scenario are set for different clocks or rates.

  /// Ends the run: what the firmware asks for is not modelled, so that all that follows would be wrong.
  void refuse(const std::string& what) {
    if (failure.empty()) failure = what + ", which is not modelled";
  }
};

}  // namespace kerfbench::cortex_m_child

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hil/source/emulator/emulator.h"
#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// Ports with quasi-bidirectional pins (Intel 1994, "Port structures and operation" of chapter 3).
///
/// A latch of 1 pulls its pin up weakly, one of 0 pulls it down: a pin is high where the latch is 1 and
/// nobody outside pulls it down. Functions of peripherals (shift clock, clock output) reach a pin whose latch
/// is 1. Pins of the STC15 can also push and pull, or only listen (PxM1, PxM0). Events tell what the
/// controller drives, as if nothing were outside: 1 for a latch of 1, 0 for a pin that only listens. Such a
/// pin reads 0 where nobody drives it.
class Ports {
 public:
  static constexpr unsigned kPorts = 6;
  Ports(const Part& part, std::size_t max_events) : part_(part), max_events_(max_events) {}

  /// All latches 1; what is outside stays.
  void reset(Tick tick);
  [[nodiscard]] bool has(unsigned port, unsigned bit) const {
    return port < kPorts && bit < 8 && (bitsOf(port) >> bit & 1U) != 0;
  }
  /// Something outside drives a pin from now on.
  void drive(unsigned index, unsigned bit, bool level);

  [[nodiscard]] std::uint8_t latch(unsigned port) const { return ports_[port].latch; }
  void setLatch(unsigned index, std::uint8_t value, Tick tick);
  /// PxM1 and PxM0 of the STC15.
  void setMode(unsigned index, bool is_m1, std::uint8_t value, Tick tick);
  /// Peripherals pull these bits down.
  void setPulledByPeripheral(unsigned index, std::uint8_t mask, bool is_low, Tick tick);
  /// Levels at the pins.
  [[nodiscard]] std::uint8_t pins(unsigned index) const;

  [[nodiscard]] bool isFlooded() const { return is_flooded_; }
  /// Events until this tick, included; later ones stay.
  std::vector<emulator::PinEvent> take(Tick until);

 private:
  struct Port {
    std::uint8_t latch{};
    std::uint8_t pulled{};  // Down, by peripherals.
    std::uint8_t m1{};      // 1 without m0: listens only.
    std::uint8_t m0{};      // 1 without m1: pushes and pulls.
    std::uint8_t outside{0xFF};
    std::uint8_t is_driven{};  // From outside.
    std::uint8_t told{};       // Level by the last event.
  };
  [[nodiscard]] static std::uint8_t driven(const Port& port);
  /// Pins that are led out: all eight of a port, but two of port 5.
  [[nodiscard]] std::uint8_t bitsOf(unsigned index) const {
    if ((part_.ports >> index & 1U) == 0) return 0;
    return index == 5 ? 0x30 : 0xFF;
  }
  void update(unsigned index, Tick tick);

  const Part& part_;
  std::size_t max_events_;
  std::array<Port, kPorts> ports_{};
  std::vector<emulator::PinEvent> events_;
  bool is_flooded_{};
};

}  // namespace kerfbench::mcs51_child

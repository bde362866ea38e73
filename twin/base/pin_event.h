// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerfbench {

/// Time of pins: an integer count at an exact rational rate. A cycle of 62.5 ns is not a whole number of
/// nanoseconds.
using Tick = std::uint64_t;

/// Seconds per tick as the exact ratio num / den (16 MHz AVR: 1 / 16 000 000).
struct TickRate {
  std::uint64_t num{1};
  std::uint64_t den{16'000'000};

  /// Time since tick 0 in seconds; exact to double rounding.
  [[nodiscard]] constexpr double seconds(Tick tick) const {
    return static_cast<double>(tick) * static_cast<double>(num) / static_cast<double>(den);
  }
  /// The last tick not after `time_s` (>= 0).
  [[nodiscard]] constexpr Tick ticksAt(double time_s) const {
    return static_cast<Tick>(time_s * static_cast<double>(den) / static_cast<double>(num));
  }
  friend constexpr bool operator==(const TickRate&, const TickRate&) = default;
};

/// One pin of the controller. Ports count from 0 (AVR: A = 0, B = 1, …), bits from 0.
struct PinId {
  std::uint16_t port{};
  std::uint16_t bit{};
  friend constexpr auto operator<=>(const PinId&, const PinId&) = default;
};

/// One write to a whole port, so that edges that are simultaneous stay so.
struct PinEvent {
  enum Flag : std::uint16_t {
    kNone = 0,
    kGap = 1,  ///< Events before this one were lost: the evidence is INVALID.
  };
  Tick tick{};
  std::uint16_t port{};
  std::uint16_t changed{};  ///< Bits that changed with this event.
  std::uint16_t level{};    ///< Levels of all bits of the port after the event.
  std::uint16_t flags{};
  friend constexpr bool operator==(const PinEvent&, const PinEvent&) = default;
};
static_assert(sizeof(PinEvent) == 16);

}  // namespace kerfbench

// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "hil/source/emulator/emulator.h"

namespace kerfbench::emulator {

/// Bits of a byte on the bench's serial line: 8N1.
inline constexpr unsigned kBitsPerByte = 10;

/// A rate of 0 says that nobody listens.
/// @throws std::runtime_error where the clock is 0 or above `most_hz`, or a byte does not fit into the clock.
void checkRates(const OpenRequest& asked, std::uint64_t most_hz);

/// Whether a receiver at one rate misses what is sent at another: the last bit of 8N1 is sampled nine bits
/// and a half after the edge that started it, so that a rate is off by too much where half a bit is lost
/// until then. Where nobody asks for a rate (0), nothing is missed.
[[nodiscard]] bool missesBytes(double rate, double asked);

/// Ticks of bytes that follow each other on the line, right in the long run where one is no whole number of
/// ticks.
class SerialPace {
 public:
  SerialPace(std::uint64_t clock_hz, std::uint32_t baud) : clock_hz_(clock_hz), baud_(baud) {}
  /// Ticks of the next byte.
  std::uint64_t next() {
    rest_ += kBitsPerByte * clock_hz_;
    const std::uint64_t ticks = rest_ / baud_;
    rest_ %= baud_;
    return ticks;
  }
  /// The line has been idle: the next byte is the first.
  void restart() { rest_ = 0; }

 private:
  std::uint64_t clock_hz_;
  std::uint32_t baud_;
  std::uint64_t rest_{};  ///< Part of a tick that bytes were too short by until now, in 1 / baud.
};

}  // namespace kerfbench::emulator

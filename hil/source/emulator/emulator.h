// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil/source/pin_stream.h"

namespace kerfbench::emulator {

/// What the bench asks for in OPEN.
struct OpenRequest {
  std::string mcu;
  std::string image_path;
  std::string eeprom;  ///< File, or kBlankEeprom; empty: what the image says of it.
  std::uint64_t clock_hz{};
  std::uint32_t baud{};        ///< Rate of the bench's UART; 0: nobody listens, and nothing is sent.
  std::uint64_t max_events{};  ///< Most pin events in one quantum; more is a flood (KB_PS_FLOODED).
};
inline constexpr const char* kBlankEeprom = "blank";

/// One event of the pin stream, see pin_stream.h.
struct PinEvent {
  std::uint64_t tick{};
  std::uint16_t port{};
  std::uint16_t changed{};
  std::uint16_t level{};
  bool operator==(const PinEvent&) const = default;
};

/// What a quantum has brought.
struct RunResult {
  kb_ps_stop stop{KB_PS_REACHED};
  std::uint64_t watermark{};     ///< Tick after which the next event lies; `until` where that was reached.
  std::vector<PinEvent> events;  ///< Ticks ascend and are not after the watermark.
  std::vector<std::uint8_t> uart;
  std::string message;  ///< Why it stopped, in words.
};

/// Ticks of an emulator.
struct Clock {
  std::uint64_t tick_num{1}, tick_den{};  ///< Seconds per tick as an exact ratio.
  std::uint32_t stamp_error_ticks{};      ///< Largest difference of a stamp from that of the silicon.
};

/// A microcontroller that runs a firmware image. What it does depends on the requests alone, and not on how
/// the time is cut into quanta.
class Emulator {
 public:
  virtual ~Emulator() = default;
  [[nodiscard]] virtual Clock clock() const = 0;
  /// Everything that decides about an event's tick.
  [[nodiscard]] virtual std::string configuration() const = 0;
  /// An input pin takes a level at a tick after the watermark. Ticks of successive calls do not descend.
  /// @throws std::runtime_error if they do; here or in run() if there is no such pin.
  virtual void drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) = 0;
  /// Bytes for the controller's UART, sent one after the other at the baud rate.
  virtual void send(std::span<const std::uint8_t> bytes) = 0;
  /// Runs to the tick `until`, or to an end before it.
  virtual RunResult run(std::uint64_t until) = 0;
};

}  // namespace kerfbench::emulator

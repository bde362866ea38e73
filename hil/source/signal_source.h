// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "twin/base/pin_event.h"

namespace kerfbench::source {

struct SourceInfo {
  TickRate rate;
  std::uint32_t stamp_err_ticks{};  ///< Declared bias and jitter of an event's tick; margins must exceed it.
  bool deterministic{};
  bool accepts_input{};   ///< False for a recording: drive() and uartWrite() are ignored.
  std::string config_id;  ///< Emulator, version, shims, run limit, SHA-256 of the image: what a rerun needs.
  /// Why the release sees files and network like any program of this user, a clause; empty: it does not.
  std::string unconfined{};
  pid_t process{};  ///< The process that runs the release, and waits between two advance(); 0: none.
};

/// Reason why advance() came back.
enum class Stop {
  kReached,   ///< The asked-for tick.
  kEnded,     ///< A recording is at its end, or the firmware has halted for good. Nothing will follow.
  kCrashed,   ///< The firmware or its emulator crashed; see message().
  kFlooded,   ///< More events or bytes in one quantum than were allowed.
  kMisheard,  ///< The firmware's UART does not run at the rate, or in the frame, that was asked for.
  kLost,      ///< Real pins can no longer be used: chip or serial line have gone, or the bench is too slow.
  kHung,      ///< The child did not answer within its wall-clock guard (a safety net, never a measurement).
};

/// Events of one quantum, in order of tick.
struct Batch {
  std::vector<PinEvent> events;
  std::vector<std::uint8_t> uart;  ///< Bytes that the controller sent.
  Tick watermark{};                ///< Nothing at or before this tick can follow.
  /// Border between the UART's bytes so far, all received at or before this tick, and those that follow, all
  /// received later. An emulator's is its watermark, a real line's the time of its last bytes.
  Tick uart_received{};
};

/// Source of pins: an emulated or native release, a recording, real pins. One interface for all.
class SignalSource {
 public:
  virtual ~SignalSource() = default;
  [[nodiscard]] virtual SourceInfo info() const = 0;
  /// Runs to `until` (> the last watermark) and replaces `batch` by what happened in (last watermark, until].
  virtual Stop advance(Tick until, Batch& batch) = 0;
  /// Promises that until `until` no input is driven and no bytes are sent, and that advance() is called in
  /// steps of `step`: the source may be ahead of its caller. Nothing else depends on it.
  virtual void foresee(Tick step, Tick until) {
    (void)step;
    (void)until;
  }
  /// Puts a level on an input pin at a tick after the last watermark; calls come in order of tick. (Live pins
  /// take more: see GpioLiveSource.)
  virtual void drive(PinId pin, bool level, Tick at) = 0;
  /// Queues bytes to the controller's UART; they go out at its baud rate, honouring its flow control.
  virtual void uartWrite(std::span<const std::uint8_t> bytes) = 0;
  /// One sentence about the last stop other than kReached.
  [[nodiscard]] virtual std::string message() const = 0;
};

}  // namespace kerfbench::source

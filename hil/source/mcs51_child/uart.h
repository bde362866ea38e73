// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "hil/source/mcs51_child/interrupts.h"
#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/ports.h"
#include "hil/source/mcs51_child/sfr.h"
#include "hil/source/mcs51_child/timers.h"

namespace kerfbench::mcs51_child {

/// A frame on the line: start bit, eight or nine bits of data, stop bit.
struct Frame {
  Tick begins{};
  Tick done{};  ///< End of the stop bit.
  double ticks_per_bit{};
  unsigned bits{};  ///< With start and stop bit: 10 or 11.
  std::uint8_t byte{};
  bool ninth{true};  ///< Data bit 9 where there is one.
};

/// The serial port in its four modes (Intel 1994, "Serial interface" of chapter 3).
///
/// A frame begins with the first rollover of the baud clock's divider after the write to SBUF, so that it
/// follows the timer and not the program. TI comes with the stop bit, RI in the middle of the received one.
class Uart {
 public:
  Uart(const Part& part, Sfrs& sfrs, Interrupts& interrupts, Ports& ports, Timers& timers);

  void reset();
  void advance(Tick tick);
  [[nodiscard]] Tick next() const;

  [[nodiscard]] std::uint8_t received() const { return received_; }
  /// SBUF is written, SCON has changed; the instruction ends at `tick`.
  void send(std::uint8_t byte, Tick tick);
  void configure(Tick tick);

  /// A frame comes in on the line. Frames come in order, and do not overlap.
  void hear(const Frame& frame) { incoming_.push_back(frame); }
  /// Frames that have begun, in order; `done` is known from the stop bit on.
  std::vector<Frame> takeSent();
  /// Frames that have begun to be sent, and the last of them; for those that watch the rate.
  [[nodiscard]] std::uint64_t begun() const { return begun_; }
  [[nodiscard]] const Frame& lastBegun() const { return current_; }
  /// Frames that came while the receiver was on and clocked, and whether the last one came before the
  /// receiver had done with the one before it.
  [[nodiscard]] std::uint64_t heard() const { return heard_; }
  [[nodiscard]] bool hasHeardTooSoon() const { return is_too_soon_; }
  /// Clocks of the oscillator in a bit that the receiver samples; 0 while its clock stands.
  [[nodiscard]] double receiveTicksPerBit() const;
  [[nodiscard]] unsigned frameBits() const { return mode() == 1 ? 10 : 11; }
  [[nodiscard]] unsigned mode() const { return sfrs_[kScon] >> 6U; }
  [[nodiscard]] bool isListening() const { return (sfrs_[kScon] & kRen) != 0 && mode() != 0; }

 private:
  enum class Stage : std::uint8_t { kNone, kWaits, kSends, kShiftsOut, kShiftsIn };
  [[nodiscard]] bool hasFixedRate() const { return mode() == 2; }
  [[nodiscard]] unsigned fixedTicksPerBit() const { return (sfrs_[kPcon] & kSmod) != 0 ? 32 : 64; }
  [[nodiscard]] Tick rollover(std::uint64_t number) const;
  [[nodiscard]] double transmitTicksPerBit() const;
  void begin(Tick tick);
  void finish(Tick tick);
  void shift(Tick tick);
  void receive(const Frame& frame);
  void setFlag(std::uint8_t mask, Tick tick);
  [[nodiscard]] unsigned shiftClock() const;

  const Part& part_;
  Sfrs& sfrs_;
  Interrupts& interrupts_;
  Ports& ports_;
  Timers& timers_;
  std::uint8_t received_{};
  Stage stage_{};
  Frame current_{};
  std::uint64_t begun_{};
  std::uint64_t first_rollover_{};  // Number of the rollover that begins the frame; a tick in mode 2.
  Tick shift_at_{};                 // Next step of the shift register in mode 0.
  unsigned shifts_{};
  std::uint8_t shifted_{};
  std::uint64_t heard_{};
  double busy_until_{};
  Tick listens_since_{};
  bool was_listening_{};
  bool is_too_soon_{};
  std::deque<Frame> incoming_;
  std::vector<Frame> sent_;
};

}  // namespace kerfbench::mcs51_child

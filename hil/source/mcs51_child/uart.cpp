// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/uart.h"

#include <algorithm>

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kRxdPin = 0x01, kTxdPin = 0x02;  // P3

}  // namespace

Uart::Uart(const Part& part, Sfrs& sfrs, Interrupts& interrupts, Ports& ports, Timers& timers)
    : part_(part), sfrs_(sfrs), interrupts_(interrupts), ports_(ports), timers_(timers) {}

void Uart::reset() {
  stage_ = Stage::kNone;
  shifts_ = 0;
  was_listening_ = false;
}

/// The tick of a rollover of the divider that makes bits.
Tick Uart::rollover(std::uint64_t number) const {
  if (hasFixedRate()) return number * fixedTicksPerBit();
  const auto clock = timers_.transmitClock();
  return clock.counter->tickOfOverflow(number * clock.overflows_per_bit);
}

double Uart::transmitTicksPerBit() const {
  if (hasFixedRate()) return fixedTicksPerBit();
  const auto clock = timers_.transmitClock();
  return static_cast<double>(clock.counter->period() * clock.overflows_per_bit);
}

double Uart::receiveTicksPerBit() const {
  if (hasFixedRate()) return fixedTicksPerBit();
  const auto clock = timers_.receiveClock();
  if (!clock.counter->runs()) return 0;
  return static_cast<double>(clock.counter->period() * clock.overflows_per_bit);
}

/// Clocks of the oscillator for a bit in mode 0.
unsigned Uart::shiftClock() const {
  constexpr std::uint8_t kStcFast = 0x20;  // UART_M0x6
  return part_.is_stc15 && (sfrs_[kAuxr] & kStcFast) != 0 ? 2 : 12;
}

void Uart::send(std::uint8_t byte, Tick tick) {
  current_ = {.byte = byte};
  if (mode() == 0) {
    stage_ = Stage::kShiftsOut;
    shifts_ = 0;
    shifted_ = byte;
    shift_at_ = tick + shiftClock();  // One cycle elapses before SEND is active.
    return;
  }
  stage_ = Stage::kWaits;
  if (hasFixedRate()) {
    first_rollover_ = tick / fixedTicksPerBit() + 1;
  } else {
    const auto clock = timers_.transmitClock();
    first_rollover_ = clock.counter->overflows() / clock.overflows_per_bit + 1;
  }
}

void Uart::configure(Tick tick) {
  if (isListening() && !was_listening_) listens_since_ = tick;
  was_listening_ = isListening();
  const bool may_shift_in = mode() == 0 && (sfrs_[kScon] & (kRen | kRi)) == kRen;
  if (may_shift_in && stage_ == Stage::kNone) {
    stage_ = Stage::kShiftsIn;
    shifts_ = 0;
    shifted_ = 0;
    shift_at_ = tick + shiftClock();
  }
}

Tick Uart::next() const {
  Tick next = incoming_.empty() ? kNever : incoming_.front().done;
  switch (stage_) {
    case Stage::kNone:
      break;
    case Stage::kWaits:
      next = std::min(next, rollover(first_rollover_));
      break;
    case Stage::kSends:
      next = std::min(next, rollover(first_rollover_ + current_.bits - 1));
      break;
    default:
      next = std::min(next, shift_at_);
  }
  return next;
}

void Uart::advance(Tick tick) {
  for (Tick due = next(); due <= tick; due = next()) {
    if (!incoming_.empty() && incoming_.front().done == due) {
      const Frame frame = incoming_.front();
      incoming_.pop_front();
      receive(frame);
    } else if (stage_ == Stage::kWaits) {
      begin(due);
    } else if (stage_ == Stage::kSends) {
      finish(due);
    } else {
      shift(due);
    }
  }
}

void Uart::begin(Tick tick) {
  stage_ = Stage::kSends;
  current_.begins = tick;
  current_.bits = frameBits();
  current_.ticks_per_bit = transmitTicksPerBit();
  current_.ninth = mode() == 1 || (sfrs_[kScon] & kTb8) != 0;
  ++begun_;
}

/// The stop bit begins.
void Uart::finish(Tick tick) {
  stage_ = Stage::kNone;
  current_.done = tick + static_cast<Tick>(current_.ticks_per_bit);
  sent_.push_back(current_);
  setFlag(kTi, tick + part_.cycle());
}

/// Mode 0: eight bits, the lowest first, data on P3.0 and the shift clock on P3.1, low in S3 to S5.
void Uart::shift(Tick tick) {
  const unsigned period = shiftClock();
  if (shifts_ == 8) {
    const bool is_out = stage_ == Stage::kShiftsOut;
    stage_ = Stage::kNone;
    ports_.setPulledByPeripheral(3, kRxdPin, false, tick);
    if (!is_out) received_ = shifted_;
    setFlag(is_out ? kTi : kRi, tick + part_.cycle());
    return;
  }
  if (stage_ == Stage::kShiftsOut) {
    ports_.setPulledByPeripheral(3, kRxdPin, (shifted_ >> shifts_ & 1U) == 0, tick);
  } else if ((ports_.pins(3) & kRxdPin) != 0) {
    shifted_ = static_cast<std::uint8_t>(shifted_ | 1U << shifts_);
  }
  ports_.setPulledByPeripheral(3, kTxdPin, true, tick + period / 3);
  ports_.setPulledByPeripheral(3, kTxdPin, false, tick + period * 5 / 6);
  ++shifts_;
  shift_at_ = tick + period;
}

/// The middle of the stop bit: RB8 and SBUF are loaded if RI is clear, and, with SM2, bit 9 or the stop bit
/// is
/// 1. Else the frame is lost.
void Uart::receive(const Frame& frame) {
  const double ticks_per_bit = receiveTicksPerBit();
  if (!isListening() || ticks_per_bit == 0 || frame.begins < listens_since_) return;
  ++heard_;
  is_too_soon_ = static_cast<double>(frame.begins) < busy_until_;
  // Behind bit 9 the receiver waits for the time of a bit.
  if (mode() != 1) busy_until_ = static_cast<double>(frame.begins) + 10.5 * ticks_per_bit;
  if ((sfrs_[kScon] & kRi) != 0) return;
  const bool ninth = mode() == 1 || frame.ninth;
  if ((sfrs_[kScon] & kSm2) != 0 && !ninth) return;
  received_ = frame.byte;
  if (mode() != 1 || (sfrs_[kScon] & kSm2) == 0) sfrs_.set(kScon, kRb8, ninth);
  setFlag(kRi, frame.done + part_.cycle());
}

void Uart::setFlag(std::uint8_t mask, Tick tick) {
  sfrs_.set(kScon, mask, true);
  interrupts_.flag(Interrupt::kSerial, tick);
}

std::vector<Frame> Uart::takeSent() {
  std::vector<Frame> taken;
  taken.swap(sent_);
  return taken;
}

}  // namespace kerfbench::mcs51_child

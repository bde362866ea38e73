// SPDX-License-Identifier: Apache-2.0
// Timer 2 of the 8052, and that of the STC15, which only reloads.
#include "hil/source/mcs51_child/timers.h"

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kStcT2Runs = 0x10, kStcT2CountsEdges = 0x08, kStcT2Fast = 0x04;  // AUXR

std::uint32_t withByte(std::uint32_t word, bool is_high, std::uint8_t value) {
  return is_high ? (word & 0x00FFU) | static_cast<std::uint32_t>(value) << 8U : (word & 0xFF00U) | value;
}

}  // namespace

bool Timers::isClockOut() const {
  return part_.has_clock_out && (sfrs_[kT2mod] & kT2oe) != 0 && (sfrs_[kT2con] & kCt2) == 0;
}

/// As a baud generator, and for the clock output, it counts each second clock of the oscillator.
void Timers::configureTimer2(Tick tick) {
  const unsigned control = sfrs_[kT2con];
  const bool reloads = (control & kCapture2) == 0 || isTimer2Baud();
  const std::uint32_t reload = static_cast<std::uint32_t>(sfrs_[kRcap2h]) << 8U | sfrs_[kRcap2l];
  timer2_.setRange(65536, reloads ? reload : 0);
  const bool runs = (control & kTr2) != 0 && (control & kCt2) == 0 && !is_stopped_;
  timer2_.setClock(runs, isTimer2Baud() || isClockOut() ? 2 : 12, tick);
}

void Timers::configureStcTimer2(Tick tick) {
  const unsigned control = sfrs_[kAuxr];
  const bool runs = (control & kStcT2Runs) != 0 && (control & kStcT2CountsEdges) == 0 && !is_stopped_;
  timer2_.setClock(runs, (control & kStcT2Fast) != 0 ? 1 : 12, tick);
}

void Timers::writeTimer2(std::uint8_t address, std::uint8_t value) {
  switch (address) {
    case kTl2:
    case kTh2:
      timer2_.set(withByte(timer2_.value(), address == kTh2, value));
      break;
    case kStcT2l:
    case kStcT2h: {
      const bool is_high = address == kStcT2h;
      timer2_.setReload(withByte(timer2_.reload(), is_high, value));
      if ((sfrs_[kAuxr] & kStcT2Runs) == 0) timer2_.set(withByte(timer2_.value(), is_high, value));
      break;
    }
    default:
      break;
  }
}

void Timers::advanceTimer2(Tick tick) {
  for (Tick overflow = timer2_.nextOverflow(); overflow <= tick; overflow = timer2_.nextOverflow()) {
    if (!isTimer2Watched()) {
      timer2_.advance(tick);
      return;
    }
    timer2_.advance(overflow);
    overflowTimer2(overflow);
  }
  timer2_.advance(tick);
}

/// Whether an overflow does more than to clock the UART.
bool Timers::isTimer2Watched() const {
  if (part_.is_stc15) return (sfrs_[kIe2] & 0x04U) != 0;
  if (isClockOut()) return true;
  return !isTimer2Baud() && (sfrs_[kT2con] & kTf2) == 0;
}

Tick Timers::nextOfTimer2() const { return isTimer2Watched() ? timer2_.nextOverflow() : kNever; }

void Timers::overflowTimer2(Tick tick) {
  if (part_.is_stc15) {
    interrupts_.flag(Interrupt::kTimer2, tick + part_.cycle());
  } else if (isClockOut()) {
    clock_output_low_ = !clock_output_low_;
    ports_.setPulledByPeripheral(1, 0x01, clock_output_low_, tick);
  } else if (!isTimer2Baud()) {
    sfrs_.set(kT2con, kTf2, true);
    interrupts_.flag(Interrupt::kTimer2, tick);
  }
}

void Timers::sampleForTimer2(const PinSampler::Sample& sample) {
  if (!part_.has_timer2) return;
  const unsigned control = sfrs_[kT2con];
  const Tick counted = sample.tick + part_.cycle();
  const bool counts = (control & (kTr2 | kCt2)) == (kTr2 | kCt2) && !is_stopped_;
  if (counts && (sample.fallen & kT2Pin) != 0 && timer2_.step(1) != 0) overflowTimer2(counted);
  if ((control & kExen2) == 0 || (sample.fallen & kT2exPin) == 0) return;
  if (!isTimer2Baud()) {
    if ((control & kCapture2) != 0) {
      sfrs_[kRcap2l] = static_cast<std::uint8_t>(timer2_.value());
      sfrs_[kRcap2h] = static_cast<std::uint8_t>(timer2_.value() >> 8U);
    } else {
      timer2_.set(timer2_.reload());
    }
  }
  sfrs_.set(kT2con, kExf2, true);
  interrupts_.flag(Interrupt::kTimer2, counted);
}

}  // namespace kerfbench::mcs51_child

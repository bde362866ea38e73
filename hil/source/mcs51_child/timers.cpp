// SPDX-License-Identifier: Apache-2.0
// Timers 0 and 1; timer 2 is in timer2.cpp.
#include "hil/source/mcs51_child/timers.h"

#include <algorithm>

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kTf0 = 0x20, kTf1 = 0x80;
constexpr unsigned kSlowUnit = 12;

}  // namespace

Timers::Timers(const Part& part, Sfrs& sfrs, Interrupts& interrupts, Ports& ports)
    : part_(part), sfrs_(sfrs), interrupts_(interrupts), ports_(ports) {
  split_.setRange(256, 0);
  timer2_.setRange(65536, 0);
}

void Timers::reset(Tick tick) {
  for (auto& timer : timers_) {
    timer.mode = 0;
    timer.reload = 0;
    timer.counter.setRange(part_.is_stc15 ? 65536 : 8192, 0);
    put(timer, 0, 0);
  }
  split_.set(0);
  timer2_.setRange(65536, 0);
  timer2_.set(0);
  clock_output_low_ = false;
  advanced_to_ = tick;
  configure(tick);
}

bool Timers::splits() const { return !part_.is_stc15 && timers_[0].mode == 3; }

/// The STC15's mode 0, and mode 3 of its timer 0, which differs in its interrupt only.
bool Timers::reloadsSixteenBits(const Timer& timer) const {
  return part_.is_stc15 && (timer.mode == 0 || (timer.mode == 3 && &timer == &timers_[0]));
}

std::uint8_t Timers::low(const Timer& timer) const {
  const std::uint32_t value = timer.counter.value();
  if (timer.mode == 0 && !part_.is_stc15) return static_cast<std::uint8_t>((value & 0x1FU) | timer.upper);
  return static_cast<std::uint8_t>(value);
}

std::uint8_t Timers::high(const Timer& timer) const {
  const std::uint32_t value = timer.counter.value();
  if (timer.counter.modulus() == 8192) return static_cast<std::uint8_t>(value >> 5U);
  if (timer.counter.modulus() == 65536) return static_cast<std::uint8_t>(value >> 8U);
  return timer.high;
}

void Timers::put(Timer& timer, std::uint8_t low, std::uint8_t high) {
  timer.high = high;
  timer.upper = low & 0xE0U;
  switch (timer.counter.modulus()) {
    case 8192:
      timer.counter.set(static_cast<std::uint32_t>(high) << 5U | (low & 0x1FU));
      break;
    case 65536:
      timer.counter.set(static_cast<std::uint32_t>(high) << 8U | low);
      break;
    default:
      timer.counter.setReload(timer.mode == 2 ? high : 0);
      timer.counter.set(low);
  }
}

void Timers::setMode(Timer& timer, std::uint8_t mode) {
  if (timer.mode == mode) return;
  const bool is_split = splits();
  const std::uint8_t old_low = low(timer);
  const std::uint8_t old_high =
      is_split && &timer == &timers_[0] ? static_cast<std::uint8_t>(split_.value()) : high(timer);
  timer.mode = mode;
  if (reloadsSixteenBits(timer)) {
    timer.counter.setRange(65536, timer.reload);
  } else if (mode == 0) {
    timer.counter.setRange(8192, 0);
  } else if (mode == 2 || (mode == 3 && &timer == &timers_[0])) {
    timer.counter.setRange(256, 0);
  } else {
    timer.counter.setRange(65536, 0);
  }
  if (splits() && &timer == &timers_[0]) split_.set(old_high);
  put(timer, old_low, old_high);
}

std::uint8_t Timers::read(std::uint8_t address) const {
  const std::uint32_t count2 = timer2_.value();
  switch (address) {
    case kTl0:
      return low(timers_[0]);
    case kTh0:
      return splits() ? static_cast<std::uint8_t>(split_.value()) : high(timers_[0]);
    case kTl1:
      return low(timers_[1]);
    case kTh1:
      return high(timers_[1]);
    case kTl2:
    case kStcT2l:
      return static_cast<std::uint8_t>(count2);
    default:
      return static_cast<std::uint8_t>(count2 >> 8U);
  }
}

/// While the STC15's timer stands, a write sets count and reload value; while it runs, the reload value only.
void Timers::writeStcReload(Timer& timer, bool is_high, std::uint8_t value, bool runs) {
  const auto with = [&](std::uint32_t word) {
    return static_cast<std::uint16_t>(is_high ? (word & 0x00FFU) | static_cast<unsigned>(value) << 8U
                                              : (word & 0xFF00U) | value);
  };
  timer.reload = with(timer.reload);
  timer.counter.setReload(timer.reload);
  if (!runs) timer.counter.set(with(timer.counter.value()));
}

void Timers::write(std::uint8_t address, std::uint8_t value) {
  if (address == kTh0 && splits()) {
    split_.set(value);
  } else if (address >= kTl0 && address <= kTh1) {
    const unsigned index = address & 1U;  // TL0, TL1, TH0, TH1
    auto& timer = timers_[index];
    const bool is_high = address >= kTh0;
    if (reloadsSixteenBits(timer)) {
      writeStcReload(timer, is_high, value, (sfrs_[kTcon] >> (4 + 2 * index) & 1U) != 0);
    } else if (is_high) {
      put(timer, low(timer), value);
    } else {
      put(timer, value, high(timer));
    }
  } else {
    writeTimer2(address, value);
  }
}

void Timers::configure(Tick tick) {
  configureTimer(0, tick);
  configureTimer(1, tick);
  if (part_.is_stc15) {
    configureStcTimer2(tick);
  } else if (part_.has_timer2) {
    configureTimer2(tick);
  }
}

void Timers::configureTimer(unsigned index, Tick tick) {
  auto& timer = timers_[index];
  const unsigned control = sfrs_[kTmod] >> (4 * index);
  setMode(timer, static_cast<std::uint8_t>(control & 3U));
  const bool is_on = (sfrs_[kTcon] >> (4 + 2 * index) & 1U) != 0;
  const bool is_gated = (control & 8U) != 0 && (levels_ & (kInt0Pin << index)) == 0;
  // Timer 0 in mode 3 takes TR1; timer 1 then runs unless it is in mode 3 itself.
  const bool runs = index == 1 && splits() ? timer.mode != 3 : is_on && !is_gated;
  const bool stands = is_stopped_ || (index == 1 && timer.mode == 3);
  timer.counts_edges = (control & 4U) != 0 && runs && !stands;
  const bool is_fast = part_.is_stc15 && (sfrs_[kAuxr] & (0x80U >> index)) != 0;
  timer.counter.setClock(runs && !stands && (control & 4U) == 0, is_fast ? 1 : kSlowUnit, tick);
  if (index == 0) {
    const bool split_runs = splits() && (sfrs_[kTcon] & 0x40U) != 0 && !is_stopped_;
    split_.setClock(split_runs, kSlowUnit, tick);
  }
}

void Timers::advanceCounter(Counter& counter, Tick tick, std::uint8_t tcon_flag, Interrupt source) {
  const Tick first = counter.nextOverflow();
  if (counter.advance(tick) == 0 || tcon_flag == 0) return;
  sfrs_.set(kTcon, tcon_flag, true);
  interrupts_.flag(source, first);
}

void Timers::advance(Tick tick) {
  if (tick <= advanced_to_) return;
  advanced_to_ = tick;
  advanceCounter(timers_[0].counter, tick, kTf0, Interrupt::kTimer0);
  advanceCounter(timers_[1].counter, tick, splits() ? std::uint8_t{0} : kTf1, Interrupt::kTimer1);
  if (splits()) advanceCounter(split_, tick, kTf1, Interrupt::kTimer1);
  advanceTimer2(tick);
}

Tick Timers::next() const {
  Tick next = kNever;
  const unsigned tcon = sfrs_[kTcon];
  if ((tcon & kTf0) == 0) next = timers_[0].counter.nextOverflow();
  if ((tcon & kTf1) == 0) {
    next = std::min(next, splits() ? split_.nextOverflow() : timers_[1].counter.nextOverflow());
  }
  return std::min(next, nextOfTimer2());
}

/// Pins whose falling edges a timer waits for.
std::uint8_t Timers::countedPins() const {
  unsigned pins = (timers_[0].counts_edges ? kT0Pin : 0U) | (timers_[1].counts_edges ? kT1Pin : 0U);
  if (part_.has_timer2) {
    const unsigned control = sfrs_[kT2con];
    pins |= ((control & kCt2) != 0 ? kT2Pin : 0U) | ((control & kExen2) != 0 ? kT2exPin : 0U);
  }
  return static_cast<std::uint8_t>(pins);
}

void Timers::sampled(const PinSampler::Sample& sample) {
  const bool gate_changed = ((levels_ ^ sample.levels) & (kInt0Pin | kInt1Pin)) != 0;
  levels_ = sample.levels;
  if (!gate_changed && (sample.fallen & countedPins()) == 0) return;
  const Tick tick = std::max(sample.tick, advanced_to_);
  advance(tick);
  // The count appears in S3P1 of the cycle after the one in which the edge was seen.
  const Tick counted = sample.tick + part_.cycle();
  for (unsigned i = 0; i < 2; ++i) {
    auto& timer = timers_[i];
    if (!timer.counts_edges || (sample.fallen & (kT0Pin << i)) == 0) continue;
    if (timer.counter.step(1) == 0 || (i == 1 && splits())) continue;
    sfrs_.set(kTcon, i == 0 ? kTf0 : kTf1, true);
    interrupts_.flag(i == 0 ? Interrupt::kTimer0 : Interrupt::kTimer1, counted);
  }
  sampleForTimer2(sample);
  if (gate_changed) configure(tick);
}

void Timers::setStopped(bool is_stopped, Tick tick) {
  advance(tick);
  is_stopped_ = is_stopped;
  configure(tick);
}

Timers::BaudClock Timers::baudClock(std::uint8_t timer2_bit) const {
  constexpr std::uint8_t kStcByTimer2 = 0x01;  // S1ST2 in AUXR
  const unsigned eight_bits = (sfrs_[kPcon] & kSmod) != 0 ? 16 : 32;
  if (part_.is_stc15) {
    if ((sfrs_[kAuxr] & kStcByTimer2) != 0) return {&timer2_, 4};
    return {&timers_[1].counter, timers_[1].mode == 2 ? eight_bits : 4};
  }
  if (part_.has_timer2 && (sfrs_[kT2con] & timer2_bit) != 0) return {&timer2_, 16};
  return {&timers_[1].counter, eight_bits};
}

Timers::BaudClock Timers::transmitClock() const { return baudClock(kTclk); }
Timers::BaudClock Timers::receiveClock() const { return baudClock(kRclk); }

}  // namespace kerfbench::mcs51_child

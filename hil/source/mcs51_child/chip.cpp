// SPDX-License-Identifier: Apache-2.0
// The run of a controller; its registers are in registers.cpp.
#include "hil/source/mcs51_child/chip.h"

#include <algorithm>
#include <utility>

namespace kerfbench::mcs51_child {
namespace {

constexpr Tick kResetClocks = 98;  // How long the AT89S52's watchdog holds RST (Atmel 2008).

Tick roundedUp(Tick tick, unsigned cycle) { return (tick + cycle - 1) / cycle * cycle; }

}  // namespace

Chip::Chip(const Part& part, const std::vector<std::uint8_t>& code, std::size_t max_events)
    : part_(part),
      clocks_(part.clocks()),
      ports_(part, max_events),
      interrupts_(part, sfrs_),
      timers_(part, sfrs_, interrupts_, ports_),
      uart_(part, sfrs_, interrupts_, ports_, timers_),
      sampler_(part.cycle()),
      cpu_(part, sfrs_, *this) {
  cpu_.load(code);
  reset(1);
}

void Chip::reset(Tick tick) {
  sfrs_.bytes = {};
  sfrs_[kSp] = 7;
  for (const std::uint8_t port : {kP0, kP1, kP2, kP3}) sfrs_[port] = 0xFF;
  if (part_.is_stc15) sfrs_[kAuxr] = 0x01;
  ports_.reset(tick);
  interrupts_.reset();
  timers_.reset(tick);
  uart_.reset();
  cpu_.reset();
  watchdog_ = kNever;
  watchdog_key_ = 0;
  pinsChanged(tick);
  refreshNext();
}

void Chip::refreshNext() { next_ = std::min({timers_.next(), uart_.next(), sampler_.next(), watchdog_}); }

/// Does what is due until `tick`, in the order of its ticks.
void Chip::advance(Tick tick) {
  while (next_ <= tick) {
    const Tick due = next_;
    timers_.advance(due);
    uart_.advance(due);
    if (sampler_.next() <= due) applySample(sampler_.commit());
    if (watchdog_ <= due) {
      watchdog_ = kNever;
      is_reset_due_ = true;  // Not in the middle of an instruction.
    }
    refreshNext();
    cpu_.attend(0);
  }
}

bool Chip::run(Tick limit) {
  const std::uint64_t frames = uart_.begun() + uart_.heard();
  for (;;) {
    execute(limit);
    bool is_settled = false;
    while (!is_settled) {
      if (now_ >= limit || !fault().empty() || ports_.isFlooded() || !end_.empty()) return false;
      is_settled = !settle();
    }
    if (now_ >= limit || ports_.isFlooded() || uart_.begun() + uart_.heard() != frames) return true;
  }
}

void Chip::execute(Tick limit) {
  const std::uint8_t power = sfrs_[kPcon];
  if ((power & (kIdle | kPowerDown)) != 0) {
    (power & kPowerDown) != 0 ? sleep(limit) : wait(limit);
    return;
  }
  // Each instruction is followed by a poll while a request waits.
  const Tick horizon = interrupts_.hasPending() ? 0 : std::min(limit, next_);
  now_ = cpu_.run(now_, horizon);
}

bool Chip::settleDue() {
  advance(now_);
  if (std::exchange(is_reset_due_, false)) {
    reset(now_);
    now_ = roundedUp(now_ + kResetClocks, part_.cycle());
    return false;
  }
  if (cpu_.takeReturnFromInterrupt()) interrupts_.returned();
  if (!interrupts_.hasPending()) return false;
  const auto source = interrupts_.poll(now_);
  if (!source) return false;
  wakeUp();
  cpu_.call(interrupts_.vectorOf(*source));
  now_ += clocks_[0x12];  // The hardware carries out an LCALL.
  refreshNext();
  return true;
}

void Chip::wakeUp() {
  const std::uint8_t power = sfrs_[kPcon];
  if ((power & kPowerDown) != 0) {
    timers_.setStopped(false, now_);
    if (watchdog_ != kNever) watchdog_ += now_ - stopped_at_;
  }
  sfrs_[kPcon] = static_cast<std::uint8_t>(power & ~unsigned{kIdle | kPowerDown});
}

/// Idle: the timers run, and each cycle ends with a poll.
void Chip::wait(Tick limit) {
  if (!interrupts_.isAnyEnabled() && watchdog_ == kNever) {
    end_ = "the firmware idles with interrupts off: nothing can wake it";
    return;
  }
  const Tick wake = std::min({next_, interrupts_.nextWake(), limit});
  now_ = std::max(now_ + part_.cycle(), roundedUp(wake, part_.cycle()));
}

/// Power-down: the oscillator stands still.
void Chip::sleep(Tick limit) {
  constexpr std::uint8_t kExternal = 0x05;  // EX0, EX1
  const bool may_wake = part_.wakes_by_interrupt && (sfrs_[kIe] & kEa) != 0 && (sfrs_[kIe] & kExternal) != 0;
  if (!may_wake) {
    end_ = "the firmware has put the controller into power-down: nothing can wake it";
    return;
  }
  now_ = std::max(now_ + part_.cycle(),
                  roundedUp(std::min({sampler_.next(), interrupts_.nextWake(), limit}), part_.cycle()));
}

void Chip::drive(unsigned port, unsigned bit, bool level, Tick tick) {
  advance(tick);
  ports_.drive(port, bit, level);
  pinsChanged(tick);
}

void Chip::hear(const Frame& frame) {
  uart_.hear(frame);
  refreshNext();
}

void Chip::pinsChanged(Tick tick) {
  const unsigned levels = (ports_.pins(3) >> 2U & 0xFU) | (ports_.pins(1) & 3U) << 4U;
  if (const auto older = sampler_.change(static_cast<std::uint8_t>(levels), tick)) {
    applySample(*older);
    refreshNext();
  }
  next_ = std::min(next_, sampler_.next());
}

void Chip::applySample(const PinSampler::Sample& sample) {
  timers_.sampled(sample);
  constexpr std::uint8_t kFlags[] = {0x02, 0x08};
  constexpr std::uint8_t kByEdge[] = {0x01, 0x04};
  constexpr Interrupt kSources[] = {Interrupt::kExternal0, Interrupt::kExternal1};
  for (unsigned i = 0; i < 2; ++i) {
    const bool by_edge = (sfrs_[kTcon] & kByEdge[i]) != 0;
    // Without IT0 or IT1 the STC15 flags both edges.
    const unsigned seen = part_.is_stc15 && !by_edge ? sample.fallen | sample.risen : sample.fallen;
    if ((by_edge || part_.is_stc15) && (seen & unsigned{kInt0Pin} << i) != 0) {
      sfrs_.set(kTcon, kFlags[i], true);
      interrupts_.flag(kSources[i], sample.tick);
    }
  }
  followLevels(sample.tick);
}

/// A flag of INT0 or INT1 that is not set by edges is the inverted pin.
void Chip::followLevels(Tick tick) {
  if (part_.is_stc15) return;
  bool has_changed = false;
  for (unsigned i = 0; i < 2; ++i) {
    const auto by_edge = static_cast<std::uint8_t>(0x01U << (2 * i));
    const auto flag = static_cast<std::uint8_t>(0x02U << (2 * i));
    if ((sfrs_[kTcon] & by_edge) != 0) continue;
    const bool is_low = (sampler_.levels() & (kInt0Pin << i)) == 0;
    if (is_low == ((sfrs_[kTcon] & flag) != 0)) continue;
    has_changed = true;
    sfrs_.set(kTcon, flag, is_low);
    if (is_low) interrupts_.flag(i == 0 ? Interrupt::kExternal0 : Interrupt::kExternal1, tick);
  }
  if (has_changed) interrupts_.written(tick);
}

}  // namespace kerfbench::mcs51_child

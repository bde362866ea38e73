// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/nvic.h"

#include <algorithm>
#include <bit>

namespace kerfbench::cortex_m_child {
namespace {

constexpr int kThreadPriority = 256;
constexpr std::uint8_t kImplementedBits = 0xF0;

/// The next exception of a set behind a number; the size of the set where there is none.
template <std::size_t kSize>
unsigned nextOf(const std::bitset<kSize>& set, unsigned number) {
  constexpr std::bitset<kSize> kLow(0xFFFFFFFF);
  for (unsigned first = ++number; first < kSize; first = number) {
    const auto word = static_cast<std::uint32_t>((set >> first & kLow).to_ulong());
    if (word != 0) return first + static_cast<unsigned>(std::countr_zero(word));
    number = first + 32;
  }
  return kSize;
}

}  // namespace

void Nvic::reset() {
  enabled_.reset();
  pending_.reset();
  active_.reset();
  lines_.reset();
  priority_.fill(0);
  for (const unsigned always : {2U, kHardFault, kSvCall, 12U, kPendSv, kSysTick}) enabled_[always] = true;
  priority_group = 0;
  primask = faultmask = false;
  basepri = 0;
}

void Nvic::setLine(unsigned interrupt, bool is_up) {
  const unsigned exception = kFirstInterrupt + interrupt;
  if (is_up && !lines_[exception]) pend(exception);
  lines_[exception] = is_up;
}

void Nvic::pend(unsigned exception) {
  pending_[exception] = true;
  has_news_ = true;
}

bool Nvic::takeNews() {
  const bool had = has_news_;
  has_news_ = false;
  return had;
}

int Nvic::rawPriority(unsigned exception) const {
  return exception <= kHardFault ? static_cast<int>(exception) - 4 : priority_[exception];
}

int Nvic::grouped(int priority) const {
  return priority < 0 ? priority : priority & ~((2 << priority_group) - 1) & 0xFF;
}

int Nvic::groupPriority(unsigned exception) const { return grouped(rawPriority(exception)); }

int Nvic::executionPriority(bool with_primask) const {
  int priority = kThreadPriority;
  for (unsigned i = nextOf(active_, 0); i < kExceptions; i = nextOf(active_, i))
    priority = std::min(priority, groupPriority(i));
  if (basepri != 0) priority = std::min(priority, grouped(basepri));
  if (with_primask && primask) priority = std::min(priority, 0);
  if (faultmask) priority = std::min(priority, -1);
  return priority;
}

/// Pending and enabled with the highest priority; among equals the lowest number.
std::optional<unsigned> Nvic::foremost() const {
  const Flags candidates = pending_ & enabled_;
  std::optional<unsigned> best;
  if (candidates.none()) return best;
  for (unsigned i = nextOf(candidates, 0); i < kExceptions; i = nextOf(candidates, i)) {
    if (!best || rawPriority(i) < rawPriority(*best)) best = i;
  }
  return best;
}

std::optional<unsigned> Nvic::next() const {
  const auto best = foremost();
  return best && groupPriority(*best) < executionPriority(true) ? best : std::nullopt;
}

bool Nvic::wakes() const {
  const auto best = foremost();
  return best && groupPriority(*best) < executionPriority(false);
}

bool Nvic::canWake(bool ticks) const {
  const Flags interrupts = enabled_ >> kFirstInterrupt;
  return ticks || interrupts.any();
}

bool Nvic::canPreempt(unsigned exception) const { return groupPriority(exception) < executionPriority(true); }

void Nvic::activate(unsigned exception) {
  pending_[exception] = false;
  active_[exception] = true;
}

void Nvic::deactivate(unsigned exception) {
  active_[exception] = false;
  if (lines_[exception]) pend(exception);
}

void Nvic::setPriority(unsigned exception, std::uint8_t value) {
  priority_[exception] = static_cast<std::uint8_t>(value & kImplementedBits);
  has_news_ = true;
}

std::uint32_t Nvic::read(std::uint32_t offset) const {
  std::uint32_t value = 0;
  if (offset >= 0x300 && offset < 0x300 + kInterrupts) {
    for (unsigned i = 0; i < 4; ++i)
      value |= std::uint32_t{priority_[kFirstInterrupt + (offset - 0x300) + i]} << (8 * i);
    return value;
  }
  const Flags& flags = offset < 0x100 ? enabled_ : offset < 0x200 ? pending_ : active_;
  const unsigned first = (offset & 0x7FU) * 8;
  for (unsigned i = 0; i < 32 && first + i < kInterrupts; ++i)
    value |= flags[kFirstInterrupt + first + i] ? 1U << i : 0;
  return value;
}

void Nvic::write(std::uint32_t offset, std::uint32_t value) {
  if (offset >= 0x300 && offset < 0x300 + kInterrupts) {
    for (unsigned i = 0; i < 4; ++i)
      setPriority(kFirstInterrupt + (offset - 0x300) + i, static_cast<std::uint8_t>(value >> (8 * i)));
    return;
  }
  if (offset >= 0x200) return;
  const bool sets = (offset & 0x80U) == 0;
  const unsigned first = (offset & 0x7FU) * 8;
  for (unsigned i = 0; i < 32 && first + i < kInterrupts; ++i) {
    const unsigned exception = kFirstInterrupt + first + i;
    if ((value >> i & 1U) == 0) continue;
    if (offset < 0x100) {
      enabled_[exception] = sets;
    } else if (sets) {
      pending_[exception] = true;
    } else {
      // A line that is still up makes it pending again at once.
      pending_[exception] = lines_[exception] && !active_[exception];
    }
  }
  has_news_ = true;
}

}  // namespace kerfbench::cortex_m_child

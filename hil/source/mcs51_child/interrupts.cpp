// SPDX-License-Identifier: Apache-2.0
#include "hil/source/mcs51_child/interrupts.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kStcEnableT2 = 0x04;  // IE2
constexpr unsigned kTimer2 = static_cast<unsigned>(Interrupt::kTimer2);

std::uint8_t bitOf(unsigned source) { return static_cast<std::uint8_t>(1U << source); }

}  // namespace

void Interrupts::reset() {
  since_ = {};
  pending_ = held_ = flagged_ = 0;
  stc_timer2_ = false;
  is_inhibited_ = false;
  in_progress_ = {};
}

std::uint8_t Interrupts::requests() const {
  const unsigned tcon = sfrs_[kTcon];
  unsigned bits = (tcon >> 1U & 1U) | (tcon >> 5U & 1U) << 1U | (tcon >> 3U & 1U) << 2U |
                  (tcon >> 7U & 1U) << 3U | ((sfrs_[kScon] & (kTi | kRi)) != 0 ? 1U << 4U : 0U);
  const bool timer2 =
      part_.is_stc15 ? stc_timer2_ : part_.has_timer2 && (sfrs_[kT2con] & (kTf2 | kExf2)) != 0;
  if (timer2) bits |= 1U << kTimer2;
  return static_cast<std::uint8_t>(bits);
}

std::uint8_t Interrupts::enabled() const {
  const unsigned ie = sfrs_[kIe];
  if ((ie & kEa) == 0) return 0;
  if (!part_.is_stc15) return static_cast<std::uint8_t>(ie & (part_.has_timer2 ? 0x3FU : 0x1FU));
  return static_cast<std::uint8_t>((ie & 0x1FU) | ((sfrs_[kIe2] & kStcEnableT2) != 0 ? 1U << kTimer2 : 0U));
}

// Timer 2 of the STC15 has the low priority always.
std::uint8_t Interrupts::highPriority() const {
  return static_cast<std::uint8_t>(sfrs_[kIp] & (part_.is_stc15 ? 0x1FU : 0x3FU));
}

std::uint8_t Interrupts::unblocked() const {
  if (in_progress_[1]) return 0;
  return in_progress_[0] ? highPriority() : std::uint8_t{0xFF};
}

void Interrupts::refresh() { pending_ = static_cast<std::uint8_t>(flagged_ & enabled() & unblocked()); }

void Interrupts::flag(Interrupt source, Tick tick) {
  const auto index = static_cast<unsigned>(source);
  if (part_.is_stc15 && source == Interrupt::kTimer2) stc_timer2_ = true;
  if ((flagged_ & bitOf(index)) == 0) since_[index] = tick;
  flagged_ = requests();
  refresh();
}

void Interrupts::written(Tick tick) {
  const std::uint8_t now = requests();
  for (unsigned i = 0; i < kInterrupts; ++i) {
    if ((now & ~flagged_ & bitOf(i)) != 0) since_[i] = tick + part_.cycle();
  }
  flagged_ = now;
  refresh();
}

std::uint8_t Interrupts::visible(Tick end) const {
  unsigned bits = 0;
  for (unsigned rest = flagged_ & unsigned{enabled()}; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(rest));
    const Tick polled = since_[i] + (i == kTimer2 ? 0 : part_.cycle());
    if (polled <= end) bits |= bitOf(i);
  }
  return static_cast<std::uint8_t>(bits);
}

std::optional<Interrupt> Interrupts::poll(Tick end) {
  const auto polled = static_cast<std::uint8_t>((std::exchange(held_, 0) | visible(end)) & unblocked());
  if (std::exchange(is_inhibited_, false) || polled == 0) return std::nullopt;
  const auto high = static_cast<std::uint8_t>(polled & highPriority());
  const unsigned chosen = high != 0 ? high : polled;
  const auto index = static_cast<unsigned>(std::countr_zero(chosen));
  in_progress_[high != 0 ? 1 : 0] = true;
  const auto source = static_cast<Interrupt>(index);
  acknowledge(source);
  flagged_ = requests();
  refresh();
  return source;
}

/// Hardware clears the flags of timers 0 and 1, and those of INT0 and INT1 that came by an edge.
void Interrupts::acknowledge(Interrupt source) {
  switch (source) {
    case Interrupt::kExternal0:
      if (part_.is_stc15 || (sfrs_[kTcon] & 0x01U) != 0) sfrs_.set(kTcon, 0x02, false);
      break;
    case Interrupt::kTimer0:
      sfrs_.set(kTcon, 0x20, false);
      break;
    case Interrupt::kExternal1:
      if (part_.is_stc15 || (sfrs_[kTcon] & 0x04U) != 0) sfrs_.set(kTcon, 0x08, false);
      break;
    case Interrupt::kTimer1:
      sfrs_.set(kTcon, 0x80, false);
      break;
    case Interrupt::kSerial:
      break;
    case Interrupt::kTimer2:
      stc_timer2_ = false;
  }
}

void Interrupts::returned() {
  is_inhibited_ = true;
  in_progress_[in_progress_[1] ? 1 : 0] = false;
  refresh();
}

Tick Interrupts::nextWake() const {
  Tick next = kNever;
  for (unsigned i = 0; i < kInterrupts; ++i) {
    if ((pending_ & bitOf(i)) == 0) continue;
    next = std::min(next, since_[i] + (i == kTimer2 ? 0 : part_.cycle()));
  }
  return next;
}

std::uint16_t Interrupts::vectorOf(Interrupt source) const {
  if (part_.is_stc15 && source == Interrupt::kTimer2) return 0x63;
  return static_cast<std::uint16_t>(3U + 8U * static_cast<unsigned>(source));
}

}  // namespace kerfbench::mcs51_child

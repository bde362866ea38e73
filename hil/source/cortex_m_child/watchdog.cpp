// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/watchdog.h"

#include <algorithm>

#include "hil/source/cortex_m_child/rcc.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kKey = 0x0, kPrescaler = 0x4, kTop = 0x8;
constexpr std::uint32_t kStart = 0xCCCC, kFeed = 0xAAAA, kUnlock = 0x5555;

}  // namespace

void Watchdog::reset() {
  prescaler_ = 0;
  top_ = 0xFFF;
  is_unlocked_ = runs_ = wants_reset_ = false;
}

std::uint32_t Watchdog::read(std::uint32_t offset) {
  if (offset == kPrescaler) return prescaler_;
  return offset == kTop ? top_ : 0;
}

void Watchdog::write(std::uint32_t offset, std::uint32_t value) {
  value &= 0xFFFFU;
  if (offset == kKey) {
    is_unlocked_ = value == kUnlock;
    if (value == kStart) runs_ = true;
    if (value == kStart || value == kFeed) reload();
  } else if (is_unlocked_ && offset == kPrescaler) {
    prescaler_ = value & 7U;
  } else if (is_unlocked_ && offset == kTop) {
    top_ = value & 0xFFFU;
  }
}

void Watchdog::reload() {
  const std::uint64_t divider = 4ULL << std::min(prescaler_, 6U);
  due_tick_ =
      time_.tickOf(present_.cycle) + (std::uint64_t{top_} + 1) * divider * time_.clockHz() / Rcc::kLsi_hz;
}

Cycle Watchdog::nextEvent() const { return runs_ ? time_.cycleAt(due_tick_) : kNever; }

void Watchdog::runTo(Cycle cycle) {
  if (nextEvent() > cycle) return;
  runs_ = false;
  wants_reset_ = true;
}

}  // namespace kerfbench::cortex_m_child

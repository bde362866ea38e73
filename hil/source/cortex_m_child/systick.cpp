// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/systick.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kControl = 0x0, kLoad = 0x4, kValue = 0x8, kCalibration = 0xC;
constexpr std::uint32_t kEnable = 1, kInterrupt = 2, kCountFlag = 1U << 16;
constexpr std::uint32_t kCalibrationValue = 9000;  // 1 ms at 9 MHz (RM0008, SysTick calibration).

}  // namespace

void SysTick::reset() {
  control_ = load_ = value_ = 0;
  base_ = present_.cycle;
}

/// Clocks until the count is 0 next; a count of 0 is loaded first.
Cycle SysTick::cyclesToZero() const { return (value_ == 0 ? Cycle{load_} + 1 : Cycle{value_}) * divider(); }

Cycle SysTick::nextEvent() const {
  if ((control_ & kEnable) == 0 || (value_ == 0 && load_ == 0)) return kNever;
  return base_ + cyclesToZero();
}

void SysTick::runTo(Cycle cycle) {
  if ((control_ & kEnable) == 0) {
    base_ = cycle;
    return;
  }
  while (nextEvent() <= cycle) {
    base_ = nextEvent();
    value_ = 0;
    control_ |= kCountFlag;
    if ((control_ & kInterrupt) != 0) nvic_.pend(kSysTick);
  }
  const Cycle counts = (cycle - base_) / divider();
  if (counts == 0) return;
  if (value_ == 0 && load_ == 0) {
    base_ = cycle;
    return;
  }
  value_ = value_ == 0 ? load_ - static_cast<std::uint32_t>(counts - 1)
                       : value_ - static_cast<std::uint32_t>(counts);
  base_ += counts * divider();
}

std::uint32_t SysTick::read(std::uint32_t offset) {
  runTo(present_.cycle);
  const std::uint32_t control = control_;
  switch (offset) {
    case kControl:
      control_ &= ~kCountFlag;
      return control;
    case kLoad:
      return load_;
    case kValue:
      return value_;
    case kCalibration:
      return kCalibrationValue;
    default:
      return 0;
  }
}

void SysTick::write(std::uint32_t offset, std::uint32_t value) {
  runTo(present_.cycle);
  if (offset == kControl) {
    control_ = (control_ & kCountFlag) | (value & 7U);
    base_ = present_.cycle;
  } else if (offset == kLoad) {
    load_ = value & 0x00FFFFFFU;
  } else if (offset == kValue) {
    value_ = 0;
    control_ &= ~kCountFlag;
    base_ = present_.cycle;
  }
}

}  // namespace kerfbench::cortex_m_child

// SPDX-License-Identifier: Apache-2.0
// Registers of a timer.
#include "hil/source/cortex_m_child/timer.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kControl1 = 0x00, kControl2 = 0x04, kSlave = 0x08, kInterruptEnables = 0x0C,
                        kStatus = 0x10, kGenerate = 0x14, kModes1 = 0x18, kModes2 = 0x1C, kEnable = 0x20,
                        kCount = 0x24, kPrescaler = 0x28, kTop = 0x2C, kRepetitions = 0x30, kCompare1 = 0x34,
                        kCompare4 = 0x40, kBreak = 0x44, kBurst = 0x4C;
constexpr std::uint32_t kDirection = 1U << 4, kTopPreload = 1U << 7;

}  // namespace

Timer::Timer(const Surroundings& around, unsigned number)
    : present_(around.present),
      nvic_(around.nvic),
      dma_(around.dma),
      pins_(around.pins),
      afio_(around.afio),
      rcc_(around.rcc),
      number_(number) {
  findPins();
}

void Timer::reset() {
  for (Channel& channel : channels_) {
    put(channel.pin, channel.shown, {});
    put(channel.complement, channel.complement_shown, {});
  }
  channels_.fill({});
  control1_ = control2_ = slave_ = interrupts_ = status_ = enable_ = break_ = 0;
  modes_[0] = modes_[1] = 0;
  count_ = prescaler_ = active_prescaler_ = repetitions_ = repetitions_left_ = 0;
  top_ = active_top_ = 0xFFFF;
  down_ = listens_ = false;
  prescaled_ = trigger_skipped_ = 0;
  base_ = present_.cycle;
  findPins();
  updateLines();
}

void Timer::raise(std::uint32_t flags) {
  status_ |= flags;
  updateLines();
}

void Timer::updateLines() {
  constexpr unsigned kTim1Update = 25, kTim1Trigger = 26, kTim1Compare = 27, kTim2 = 28;
  const std::uint32_t up = status_ & interrupts_ & 0xFFU;
  if (number_ == 1) {
    nvic_.setLine(kTim1Update, (up & 1U) != 0);
    nvic_.setLine(kTim1Trigger, (up & 0x60U) != 0);
    nvic_.setLine(kTim1Compare, (up & 0x1EU) != 0);
  } else {
    nvic_.setLine(kTim2 + number_ - 2, up != 0);
  }
}

std::uint32_t Timer::read(std::uint32_t offset) {
  runTo(present_.cycle);
  if (offset >= kCompare1 && offset <= kCompare4) {
    const unsigned channel = (offset - kCompare1) / 4;
    if (isInput(channel)) {
      status_ &= ~(2U << channel);
      updateLines();
    }
    return channels_[channel].compare;
  }
  switch (offset) {
    case kControl1:
      return (control1_ & ~kDirection) | (down_ ? kDirection : 0U);
    case kControl2:
      return control2_;
    case kSlave:
      return slave_;
    case kInterruptEnables:
      return interrupts_;
    case kStatus:
      return status_;
    case kModes1:
    case kModes2:
      return modes_[(offset - kModes1) / 4];
    case kEnable:
      return enable_;
    case kCount:
      return count_;
    case kPrescaler:
      return prescaler_;
    case kTop:
      return top_;
    case kRepetitions:
      return repetitions_;
    case kBreak:
      return break_;
    default:
      return 0;
  }
}

void Timer::write(std::uint32_t offset, std::uint32_t value) {
  runTo(present_.cycle);
  value &= 0xFFFFU;
  if (offset <= kSlave) {
    writeControl(offset, value);
  } else if (offset == kGenerate) {
    generate(value);
  } else if (offset >= kCount) {
    writeCount(offset, value);
  } else if (offset == kInterruptEnables) {
    interrupts_ = value & 0x7FFFU;
  } else if (offset == kStatus) {
    status_ &= value;
  } else if (offset == kEnable) {
    enable_ = value & 0x3FFFU;
  } else {
    modes_[(offset - kModes1) / 4] = value;
  }
  for (unsigned i = 0; i < kChannels; ++i) {
    if (!isInput(i)) updateReference(i, false);
  }
  refuseUnmodelled();
  listen();
  showOutputs();
  updateLines();
}

/// Whether levels of pins matter to what is set now; where they begin to, they are looked at.
void Timer::listen() {
  bool listens = source() != Source::kInternal;
  for (unsigned i = 0; i < kChannels; ++i) listens = listens || isInput(i);
  if (listens && !listens_) findPins();
  listens_ = listens;
}

void Timer::writeControl(std::uint32_t offset, std::uint32_t value) {
  if (offset == kControl2) control2_ = value & 0x7FF8U;
  if (offset == kSlave) slave_ = value;
  if (offset != kControl1) return;
  const bool starts = (value & 1U) != 0 && !counts();
  control1_ = value & 0x3FFU;
  if (!isCentred()) down_ = (value & kDirection) != 0;
  // The first count comes a clock after CEN, and the prescaler starts anew.
  if (starts) base_ = present_.cycle + 1;
}

void Timer::writeCount(std::uint32_t offset, std::uint32_t value) {
  if (offset >= kCompare1 && offset <= kCompare4) {
    const unsigned channel = (offset - kCompare1) / 4;
    if (isInput(channel)) return;
    channels_[channel].compare = value;
    if (!isPreloaded(channel)) channels_[channel].active_compare = value;
    return;
  }
  switch (offset) {
    case kCount:
      count_ = value;
      break;
    case kPrescaler:
      prescaler_ = value;
      break;
    case kTop:
      top_ = value;
      if ((control1_ & kTopPreload) == 0) active_top_ = value;
      break;
    case kRepetitions:
      if (number_ == 1) repetitions_ = value & 0xFFU;
      break;
    case kBreak:
      if (number_ == 1) break_ = value;
      break;
    case kBurst:
      present_.refuse("the firmware writes a DMA burst to TIM" + std::to_string(number_));
      break;
    default:
      break;
  }
}

/// Events by software: EGR.
void Timer::generate(std::uint32_t events) {
  if ((events & 1U) != 0) {
    count_ = down_ && !isCentred() ? active_top_ : 0;
    if (isCentred()) down_ = false;
    prescaled_ = 0;
    base_ = present_.cycle;
    onUpdate(true);
    if (down_) count_ = active_top_;
  }
  for (unsigned i = 0; i < kChannels; ++i) {
    if ((events >> (i + 1) & 1U) == 0) continue;
    if (isInput(i)) {
      capture(i);
    } else {
      raise(2U << i);
    }
  }
  raise(events & 0x60U);
}

void Timer::refuseUnmodelled() {
  const std::string own = "TIM" + std::to_string(number_);
  const std::uint32_t slave_mode = slave_ & 7U;
  if (slave_mode >= 4 && slave_mode <= 6)
    present_.refuse("the firmware sets slave mode " + std::to_string(slave_mode) + " of " + own);
  if (slave_mode == 7 && (slave_ >> 4 & 7U) < 4)
    present_.refuse("the firmware clocks " + own + " by another timer");
  if ((break_ >> 12 & 1U) != 0) present_.refuse("the firmware sets the break input of TIM1");
  if (number_ == 1 && (break_ & 0xFFU) != 0 && (enable_ & 0x444U) != 0)
    present_.refuse("the firmware sets a dead time of TIM1");
}

}  // namespace kerfbench::cortex_m_child

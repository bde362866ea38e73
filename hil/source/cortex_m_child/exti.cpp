// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/exti.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kLines = 0x7FFFF;
constexpr unsigned kPinLines = 16, kUsbLine = 18;

}  // namespace

std::uint32_t Afio::read(std::uint32_t offset) {
  if (offset == 0x00) return event_;
  if (offset == 0x04) return remap_ & ~(7U << 24);  // SWJ_CFG can be written only.
  return offset >= 0x08 && offset < 0x18 ? lines_[(offset - 0x08) / 4] : 0;
}

void Afio::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x00) event_ = value & 0xFFU;
  if (offset >= 0x08 && offset < 0x18) lines_[(offset - 0x08) / 4] = value & 0xFFFFU;
  if (offset == 0x04) {
    remap_ = value;
    if (on_remap) on_remap();
  }
}

void Afio::reset() {
  event_ = remap_ = 0;
  lines_.fill(0);
}

std::uint32_t Exti::read(std::uint32_t offset) {
  const std::uint32_t* const kRegisters[] = {&interrupts_, &events_,   &rising_,
                                             &falling_,    &software_, &pending_};
  return offset / 4 < std::size(kRegisters) ? *kRegisters[offset / 4] : 0;
}

void Exti::write(std::uint32_t offset, std::uint32_t value) {
  value &= kLines;
  switch (offset) {
    case 0x00:
      interrupts_ = value;
      break;
    case 0x04:
      events_ = value;
      break;
    case 0x08:
      rising_ = value;
      break;
    case 0x0C:
      falling_ = value;
      break;
    case 0x10: {
      const std::uint32_t set = value & ~software_;
      software_ |= value;
      for (unsigned line = 0; line < 19; ++line) {
        if ((set >> line & 1U) != 0) trigger(line);
      }
      break;
    }
    case 0x14:
      pending_ &= ~value;
      software_ &= ~value;
      break;
    default:
      break;
  }
  updateLines();
}

void Exti::reset() {
  interrupts_ = events_ = rising_ = falling_ = software_ = pending_ = 0;
  updateLines();
}

void Exti::onPins(unsigned port, std::uint32_t changed) {
  for (unsigned line = 0; line < kPinLines; ++line) {
    if ((changed >> line & 1U) == 0 || afio_.interruptPort(line) != port) continue;
    const bool rises = pins_.level({port, line});
    if (((rises ? rising_ : falling_) >> line & 1U) != 0) trigger(line);
  }
  updateLines();
}

void Exti::onUsbWakeUp() {
  if ((rising_ >> kUsbLine & 1U) != 0) trigger(kUsbLine);
  updateLines();
}

void Exti::trigger(unsigned line) {
  pending_ |= 1U << line;
  if ((events_ >> line & 1U) != 0 && on_event) on_event();
}

void Exti::updateLines() {
  constexpr unsigned kFirst = 6, kLines5To9 = 23, kLines10To15 = 40, kUsbWakeUp = 42;
  const std::uint32_t up = pending_ & interrupts_;
  for (unsigned line = 0; line < 5; ++line) nvic_.setLine(kFirst + line, (up >> line & 1U) != 0);
  nvic_.setLine(kLines5To9, (up & 0x3E0U) != 0);
  nvic_.setLine(kLines10To15, (up & 0xFC00U) != 0);
  nvic_.setLine(kUsbWakeUp, (up >> kUsbLine & 1U) != 0);
}

}  // namespace kerfbench::cortex_m_child

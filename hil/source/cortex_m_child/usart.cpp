// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/usart.h"

#include <algorithm>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kStatus = 0x00, kData = 0x04, kRate = 0x08, kControl1 = 0x0C, kControl2 = 0x10,
                        kControl3 = 0x14, kGuard = 0x18;
constexpr std::uint32_t kErrors = 0x0F, kOverrun = 1U << 3, kIdle = 1U << 4, kReceived = 1U << 5,
                        kComplete = 1U << 6, kEmpty = 1U << 7;
constexpr std::uint32_t kDmaReceives = 1U << 6, kDmaTransmits = 1U << 7;
constexpr unsigned kFirstInterruptLine = 37;

}  // namespace

void Usart::reset() {
  status_ = kEmpty | kComplete;
  received_ = rate_ = control1_ = control2_ = control3_ = guard_ = 0;
  status_was_read_ = holds_byte_ = false;
  shift_ends_at_ = idle_at_ = kNever;
  updateLines();
}

Cycle Usart::cyclesPerBit() const {
  return Cycle{rate_} * rcc_.divider(number_ == 1 ? ClockBus::kApb2 : ClockBus::kApb1);
}

/// Start bit, eight or nine bits with the parity's, and stop bits, of which half a one is counted as one.
unsigned Usart::bitsPerFrame() const {
  const bool has_nine = (control1_ >> 12 & 1U) != 0;
  const std::uint32_t stop = control2_ >> 12 & 3U;
  return 1U + (has_nine ? 9U : 8U) + (stop >= 2 ? 2U : 1U);
}

bool Usart::receives() const { return (control1_ >> 13 & 1U) != 0 && (control1_ >> 2 & 1U) != 0; }

std::uint32_t Usart::read(std::uint32_t offset) {
  switch (offset) {
    case kStatus:
      status_was_read_ = true;
      return status_;
    case kData:
      if (status_was_read_) status_ &= ~(kErrors | kIdle);
      status_was_read_ = false;
      status_ &= ~kReceived;
      updateLines();
      return received_;
    case kRate:
      return rate_;
    case kControl1:
      return control1_;
    case kControl2:
      return control2_;
    case kControl3:
      return control3_;
    case kGuard:
      return guard_;
    default:
      return 0;
  }
}

void Usart::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kStatus:
      status_ &= value | ~(kReceived | kComplete);
      break;
    case kData:
      if (status_was_read_) status_ &= ~kComplete;
      status_was_read_ = false;
      if (transmits()) load(static_cast<std::uint8_t>(value));
      break;
    case kRate:
      rate_ = value & 0xFFFFU;
      break;
    case kControl1:
      writeControl(value & 0x3FFFU);
      break;
    case kControl2:
      control2_ = value & 0x7FFFU;
      break;
    case kControl3:
      control3_ = value & 0x7FFU;
      break;
    case kGuard:
      guard_ = value & 0xFFFFU;
      break;
    default:
      break;
  }
  refuseUnmodelled();
  updateLines();
  serveDma();
}

void Usart::writeControl(std::uint32_t value) {
  const bool had_transmitter = transmits();
  control1_ = value;
  // A transmitter that is switched on sends an idle frame first.
  if (!had_transmitter && transmits() && rate_ != 0)
    shift_ends_at_ = present_.cycle + cyclesPerBit() * bitsPerFrame();
}

void Usart::load(std::uint8_t byte) {
  if (shift_ends_at_ != kNever) {
    holds_byte_ = true;
    held_byte_ = byte;
    status_ &= ~kEmpty;
    return;
  }
  status_ &= ~kComplete;
  status_ |= kEmpty;
  shift_ends_at_ = present_.cycle + std::max<Cycle>(1, cyclesPerBit() * bitsPerFrame());
  if (on_transmit) on_transmit(*this, byte, shift_ends_at_);
}

void Usart::receive(std::uint8_t byte) {
  if (!receives()) return;
  idle_at_ = present_.cycle + cyclesPerBit() * bitsPerFrame();
  if ((status_ & kReceived) != 0) {
    status_ |= kOverrun;
  } else {
    received_ = byte;
    status_ |= kReceived;
  }
  updateLines();
  serveDma();
}

Cycle Usart::nextEvent() const { return std::min(shift_ends_at_, idle_at_); }

void Usart::runTo(Cycle cycle) {
  if (idle_at_ <= cycle) {
    idle_at_ = kNever;
    status_ |= kIdle;
  }
  if (shift_ends_at_ <= cycle) {
    shift_ends_at_ = kNever;
    if (holds_byte_) {
      holds_byte_ = false;
      load(held_byte_);
    } else {
      status_ |= kComplete;
    }
  }
  updateLines();
  serveDma();
}

void Usart::serveDma() {
  static constexpr unsigned kTransmit[] = {4, 7, 2}, kReceive[] = {5, 6, 3};
  if ((control3_ & kDmaReceives) != 0 && (status_ & kReceived) != 0)
    (void)dma_.request(kReceive[number_ - 1]);
  while ((control3_ & kDmaTransmits) != 0 && (status_ & kEmpty) != 0 && transmits() && rate_ != 0) {
    if (!dma_.request(kTransmit[number_ - 1])) break;
  }
}

void Usart::updateLines() {
  // RXNEIE, TCIE, TXEIE and IDLEIE are at the places of their flags.
  const std::uint32_t up = status_ & control1_ & (kReceived | kComplete | kEmpty | kIdle);
  const bool overruns = (status_ & kOverrun) != 0 && ((control1_ & kReceived) != 0 || (control3_ & 1U) != 0);
  nvic_.setLine(kFirstInterruptLine + number_ - 1, (up != 0 && (control1_ >> 13 & 1U) != 0) || overruns);
}

void Usart::refuseUnmodelled() {
  const std::string own = " of USART" + std::to_string(number_);
  if ((control2_ & (1U << 11 | 1U << 14)) != 0)
    present_.refuse("the firmware sets the synchronous or LIN mode" + own);
  if ((control3_ & 0x2EU) != 0)
    present_.refuse("the firmware sets the IrDA, half-duplex or smartcard mode" + own);
}

}  // namespace kerfbench::cortex_m_child

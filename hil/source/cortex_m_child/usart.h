// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/dma.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/rcc.h"

namespace kerfbench::cortex_m_child {

/// USART1 to USART3 as asynchronous lines (STMicroelectronics 2015 RM0008, chapter 27): a byte in the shift
/// register and one that waits, overrun, idle line, interrupts and DMA. Bytes are handed over whole, at the
/// end of their frame; parity, noise and framing errors do not occur.
class Usart final : public Device {
 public:
  /// @param number 1 to 3.
  Usart(Present& present, Nvic& nvic, Dma& dma, const Rcc& rcc, unsigned number)
      : present_(present), nvic_(nvic), dma_(dma), rcc_(rcc), number_(number) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;
  void serveDma() override;

  /// A frame begins on the line: it is not idle.
  void beginReceiving() { idle_at_ = kNever; }
  void receive(std::uint8_t byte);
  [[nodiscard]] bool receives() const;
  /// Whether the receiver, with RTS, asks the other side to wait.
  [[nodiscard]] bool holdsOff() const { return (control3_ >> 8 & 1U) != 0 && (status_ & 0x20U) != 0; }
  [[nodiscard]] Cycle cyclesPerBit() const;
  [[nodiscard]] unsigned bitsPerFrame() const;
  [[nodiscard]] unsigned number() const { return number_; }
  /// Called as the frame of a byte begins, with the cycle of its end.
  std::function<void(const Usart&, std::uint8_t byte, Cycle end)> on_transmit;

 private:
  [[nodiscard]] bool transmits() const { return (control1_ >> 13 & 1U) != 0 && (control1_ >> 3 & 1U) != 0; }
  void writeControl(std::uint32_t value);
  void load(std::uint8_t byte);
  void updateLines();
  void refuseUnmodelled();

  Present& present_;
  Nvic& nvic_;
  Dma& dma_;
  const Rcc& rcc_;
  unsigned number_;
  std::uint32_t status_{0xC0};
  std::uint32_t received_{};
  std::uint32_t rate_{};
  std::uint32_t control1_{}, control2_{}, control3_{}, guard_{};
  bool status_was_read_{};
  bool holds_byte_{};  ///< A byte waits for the shift register.
  std::uint8_t held_byte_{};
  Cycle shift_ends_at_{kNever};
  Cycle idle_at_{kNever};
};

}  // namespace kerfbench::cortex_m_child

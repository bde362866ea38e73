// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/pins.h"

namespace kerfbench::cortex_m_child {

/// Alternate functions and their pins: AFIO (STMicroelectronics 2015 RM0008, chapter 9).
class Afio final : public Device {
 public:
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  /// The port whose pin of this number is the external interrupt's.
  [[nodiscard]] unsigned interruptPort(unsigned line) const {
    return lines_[line / 4] >> (4 * (line % 4)) & 0xFU;
  }
  [[nodiscard]] std::uint32_t remap() const { return remap_; }
  /// Called after pins of devices may have moved.
  std::function<void()> on_remap;

 private:
  std::uint32_t event_{};
  std::uint32_t remap_{};
  std::array<std::uint32_t, 4> lines_{};
};

/// External interrupts of edges (RM0008, chapter 10). Lines 16 and 17 (voltage, clock) never have
/// one.
class Exti final : public Device {
 public:
  Exti(Nvic& nvic, const Pins& pins, const Afio& afio) : nvic_(nvic), pins_(pins), afio_(afio) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  void onPins(unsigned port, std::uint32_t changed);
  /// The bus wakes a USB device that was suspended: a rising edge on line 18.
  void onUsbWakeUp();
  /// Called with an edge whose event is not masked: what ends WFE.
  std::function<void()> on_event;

 private:
  void trigger(unsigned line);
  void updateLines();

  Nvic& nvic_;
  const Pins& pins_;
  const Afio& afio_;
  std::uint32_t interrupts_{};  ///< IMR
  std::uint32_t events_{};      ///< EMR
  std::uint32_t rising_{};
  std::uint32_t falling_{};
  std::uint32_t software_{};
  std::uint32_t pending_{};
};

}  // namespace kerfbench::cortex_m_child

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>

#include "hil/source/cortex_m_child/device.h"

namespace kerfbench::cortex_m_child {

/// The three buses with clocks of their own for devices.
enum class ClockBus { kAhb, kApb1, kApb2, kAlways };

/// Reset and clock control (STMicroelectronics 2015 RM0008, chapter 7): HSI of 8 MHz, HSE of 8 MHz as on
/// nearly all boards, PLL, prescalers. Oscillators and PLL are ready as soon as they are switched on.
class Rcc final : public Device {
 public:
  static constexpr std::uint64_t kHse_hz = 8'000'000, kHsi_hz = 8'000'000, kLsi_hz = 40'000;

  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  [[nodiscard]] std::uint64_t coreHz() const;
  /// Cycles of the core in a clock of a bus: 1 to 16.
  [[nodiscard]] unsigned divider(ClockBus bus) const;
  /// Cycles of the core in a clock of the timers of a bus.
  [[nodiscard]] unsigned timerDivider(ClockBus bus) const;
  /// Clock of the USB device, from the PLL; 0 where that is off.
  [[nodiscard]] std::uint64_t usbHz() const;
  [[nodiscard]] bool isOn(ClockBus bus, unsigned bit) const;
  /// What the core's clock is made of, in words.
  [[nodiscard]] std::string clockInWords() const;
  /// Cause of a reset, kept in RCC_CSR: a bit of 26 to 31.
  void recordReset(unsigned bit) { status_ |= 1U << bit; }
  /// Called with the devices of a bus that the firmware resets.
  std::function<void(ClockBus, std::uint32_t bits)> on_reset;

 private:
  [[nodiscard]] std::uint64_t systemHz() const;
  [[nodiscard]] std::uint64_t pllHz() const;
  [[nodiscard]] std::uint32_t control() const;

  std::uint32_t control_{0x83};
  std::uint32_t configuration_{};
  std::array<std::uint32_t, 3> enabled_{0x14, 0, 0};  ///< AHB, APB1, APB2.
  std::uint32_t status_{};
  std::uint32_t backup_{};
};

}  // namespace kerfbench::cortex_m_child

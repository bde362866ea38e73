// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/nvic.h"

namespace kerfbench::cortex_m_child {

/// SysTick (ARMv7-M 2010, B3.3): counts down from LOAD and makes its exception pending as it reaches 0, each
/// LOAD + 1 clocks. Its clock is the core's or an eighth of that.
class SysTick final : public Device {
 public:
  SysTick(Present& present, Nvic& nvic) : present_(present), nvic_(nvic) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;
  [[nodiscard]] bool ticks() const { return (control_ & 3U) == 3U && load_ != 0; }

 private:
  [[nodiscard]] Cycle divider() const { return (control_ & 4U) != 0 ? 1 : 8; }
  [[nodiscard]] Cycle cyclesToZero() const;

  Present& present_;
  Nvic& nvic_;
  std::uint32_t control_{};
  std::uint32_t load_{};
  std::uint32_t value_{};
  Cycle base_{};  ///< Cycle at which value_ was the count.
};

}  // namespace kerfbench::cortex_m_child

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/device.h"

namespace kerfbench::cortex_m_child {

/// Independent watchdog (STMicroelectronics 2015 RM0008, chapter 19): counts down by an oscillator of its
/// own, of 40 kHz here and 30 to 60 kHz on silicon, and resets the part when it reaches 0. Only a reset stops
/// it.
class Watchdog final : public Device {
 public:
  Watchdog(Present& present, const CoreTime& time) : present_(present), time_(time) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;
  [[nodiscard]] Cycle nextEvent() const override;
  void runTo(Cycle cycle) override;
  [[nodiscard]] bool takeResetRequest() { return std::exchange(wants_reset_, false); }

 private:
  void reload();

  Present& present_;
  const CoreTime& time_;
  std::uint32_t prescaler_{};
  std::uint32_t top_{0xFFF};
  bool is_unlocked_{};
  bool runs_{};
  bool wants_reset_{};
  std::uint64_t due_tick_{};
};

}  // namespace kerfbench::cortex_m_child

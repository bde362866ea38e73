// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/systick.h"

namespace kerfbench::cortex_m_child {

/// The core's own registers from 0xE0000000 on: NVIC, SysTick, system control block, the cycle counter of the
/// DWT, and the identity of the part. Trace and patch units read 0 and take no notice.
class SystemControl final : public Device {
 public:
  SystemControl(Present& present, Nvic& nvic, SysTick& systick, std::uint32_t device_id)
      : present_(present), nvic_(nvic), systick_(systick), device_id_(device_id) {}
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  [[nodiscard]] std::uint32_t vectorTable() const { return vector_table_; }
  [[nodiscard]] bool alignsStack() const { return (configuration_ & 0x200U) != 0; }
  [[nodiscard]] bool trapsUnaligned() const { return (configuration_ & 8U) != 0; }
  [[nodiscard]] bool trapsDivision() const { return (configuration_ & 0x10U) != 0; }
  [[nodiscard]] bool sleepsOnExit() const { return (sleep_ & 2U) != 0; }
  [[nodiscard]] bool eventOnPending() const { return (sleep_ & 0x10U) != 0; }
  void setCurrent(unsigned exception) { current_ = exception; }
  /// Bits of CFSR, and the address of a bad access.
  void recordFault(std::uint32_t status, std::uint32_t address);
  void recordHardFault(std::uint32_t status) { hard_fault_ |= status; }
  [[nodiscard]] bool takeResetRequest();

 private:
  std::uint32_t readBlock(std::uint32_t offset) const;
  void writeBlock(std::uint32_t offset, std::uint32_t value);
  [[nodiscard]] std::uint32_t interruptState() const;
  void setInterruptState(std::uint32_t value);
  [[nodiscard]] std::uint32_t cycleCount() const;
  void writeCycleCounter(std::uint32_t offset, std::uint32_t value);

  Present& present_;
  Nvic& nvic_;
  SysTick& systick_;
  std::uint32_t device_id_;
  unsigned current_{};
  std::uint32_t vector_table_{kFlashBase};
  std::uint32_t sleep_{};
  std::uint32_t configuration_{0x200};
  std::uint32_t fault_status_{};
  std::uint32_t hard_fault_{};
  std::uint32_t fault_address_{};
  std::uint32_t debug_control_{};
  std::uint32_t counter_control_{};
  std::uint32_t count_{};  ///< CYCCNT as it was when it was last written or stopped.
  Cycle count_since_{};
  bool wants_reset_{};
};

}  // namespace kerfbench::cortex_m_child

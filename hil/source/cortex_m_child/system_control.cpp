// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/system_control.h"

#include <utility>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kDwt = 0x1000, kCycleCount = 0x1004;
constexpr std::uint32_t kControllerType = 0xE004, kSysTickBlock = 0xE010, kNvicBlock = 0xE100;
constexpr std::uint32_t kBlock = 0xED00, kDebugControl = 0xEDFC, kSoftwareTrigger = 0xEF00;
constexpr std::uint32_t kIdentity = 0x42000;
constexpr std::uint32_t kCpuId = 0x412FC231;  // Cortex-M3 r2p1
constexpr std::uint32_t kDwtControl = 0x40000000;
constexpr std::uint32_t kVectorKey = 0x05FA, kVectorKeyRead = 0xFA05;
constexpr std::uint32_t kRevision = 0x20030000;

}  // namespace

void SystemControl::reset() {
  vector_table_ = kFlashBase;
  sleep_ = 0;
  configuration_ = 0x200;
  fault_status_ = hard_fault_ = 0;
  debug_control_ = counter_control_ = count_ = 0;
  wants_reset_ = false;
}

void SystemControl::recordFault(std::uint32_t status, std::uint32_t address) {
  constexpr std::uint32_t kPreciseBus = 1U << 9, kAddressIsValid = 1U << 15;
  fault_status_ |= status;
  if ((status & kPreciseBus) == 0) return;
  fault_status_ |= kAddressIsValid;
  fault_address_ = address;
}

bool SystemControl::takeResetRequest() { return std::exchange(wants_reset_, false); }

std::uint32_t SystemControl::cycleCount() const {
  const bool counts = (counter_control_ & 1U) != 0 && (debug_control_ & (1U << 24)) != 0;
  return counts ? count_ + static_cast<std::uint32_t>(present_.cycle - count_since_) : count_;
}

std::uint32_t SystemControl::read(std::uint32_t offset) {
  if (offset == kDwt) return kDwtControl | counter_control_;
  if (offset == kCycleCount) return cycleCount();
  if (offset == kControllerType) return (kInterrupts - 1) / 32;
  if (offset == kDebugControl) return debug_control_;
  if (offset == kIdentity) return kRevision | device_id_;
  if (offset >= kSysTickBlock && offset < kSysTickBlock + 0x10) return systick_.read(offset - kSysTickBlock);
  if (offset >= kNvicBlock && offset < kBlock) return nvic_.read(offset - kNvicBlock);
  if (offset >= kBlock && offset < kBlock + 0x40) return readBlock(offset - kBlock);
  return 0;
}

void SystemControl::writeCycleCounter(std::uint32_t offset, std::uint32_t value) {
  count_ = offset == kCycleCount ? value : cycleCount();
  count_since_ = present_.cycle;
  if (offset == kDwt) counter_control_ = value & 1U;
  if (offset == kDebugControl) debug_control_ = value & (1U << 24);
}

void SystemControl::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kDwt || offset == kCycleCount || offset == kDebugControl) writeCycleCounter(offset, value);
  if (offset >= kSysTickBlock && offset < kSysTickBlock + 0x10) systick_.write(offset - kSysTickBlock, value);
  if (offset >= kNvicBlock && offset < kBlock) nvic_.write(offset - kNvicBlock, value);
  if (offset >= kBlock && offset < kBlock + 0x40) writeBlock(offset - kBlock, value);
  if (offset == kSoftwareTrigger && (value & 0x1FFU) < kInterrupts)
    nvic_.pend(kFirstInterrupt + (value & 0x1FFU));
}

std::uint32_t SystemControl::interruptState() const {
  const auto next = nvic_.next();
  return (nvic_.isPending(kPendSv) ? 1U << 28 : 0U) | (nvic_.isPending(kSysTick) ? 1U << 26 : 0U) |
         next.value_or(0) << 12 | (nvic_.activeExceptions() <= 1 ? 1U << 11 : 0U) | current_;
}

void SystemControl::setInterruptState(std::uint32_t value) {
  if ((value >> 31 & 1U) != 0) nvic_.pend(2);
  if ((value >> 28 & 1U) != 0) nvic_.pend(kPendSv);
  if ((value >> 27 & 1U) != 0) nvic_.clearPending(kPendSv);
  if ((value >> 26 & 1U) != 0) nvic_.pend(kSysTick);
  if ((value >> 25 & 1U) != 0) nvic_.clearPending(kSysTick);
}

std::uint32_t SystemControl::readBlock(std::uint32_t offset) const {
  switch (offset) {
    case 0x00:
      return kCpuId;
    case 0x04:
      return interruptState();
    case 0x08:
      return vector_table_;
    case 0x0C:
      return kVectorKeyRead << 16 | nvic_.priority_group << 8;
    case 0x10:
      return sleep_;
    case 0x14:
      return configuration_;
    case 0x18:
    case 0x1C:
    case 0x20: {
      std::uint32_t value = 0;
      for (unsigned i = 0; i < 4; ++i)
        value |= std::uint32_t{nvic_.priority(offset - 0x18 + 4 + i)} << (8 * i);
      return value;
    }
    case 0x24:
      return (nvic_.isEnabled(kMemManage) ? 1U << 16 : 0U) | (nvic_.isEnabled(kBusFault) ? 1U << 17 : 0U) |
             (nvic_.isEnabled(kUsageFault) ? 1U << 18 : 0U);
    case 0x28:
      return fault_status_;
    case 0x2C:
      return hard_fault_;
    case 0x34:
    case 0x38:
      return fault_address_;
    default:
      return 0;
  }
}

void SystemControl::writeBlock(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x04:
      return setInterruptState(value);
    case 0x08:
      vector_table_ = value & 0x3FFFFF80U;
      if (vector_table_ == 0) vector_table_ = kFlashBase;
      return;
    case 0x0C:
      if (value >> 16 != kVectorKey) return;
      nvic_.priority_group = value >> 8 & 7U;
      wants_reset_ = wants_reset_ || (value & 5U) != 0;
      return;
    case 0x10:
      sleep_ = value & 0x16U;
      return;
    case 0x14:
      configuration_ = value & 0x31BU;
      return;
    case 0x18:
    case 0x1C:
    case 0x20:
      for (unsigned i = 0; i < 4; ++i)
        nvic_.setPriority(offset - 0x18 + 4 + i, static_cast<std::uint8_t>(value >> (8 * i)));
      return;
    case 0x24:
      nvic_.setEnabled(kMemManage, (value >> 16 & 1U) != 0);
      nvic_.setEnabled(kBusFault, (value >> 17 & 1U) != 0);
      nvic_.setEnabled(kUsageFault, (value >> 18 & 1U) != 0);
      return;
    case 0x28:
      fault_status_ &= ~value;
      return;
    case 0x2C:
      hard_fault_ &= ~value;
      return;
    default:
      return;
  }
}

}  // namespace kerfbench::cortex_m_child

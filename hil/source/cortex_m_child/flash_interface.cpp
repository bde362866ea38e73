// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/flash_interface.h"

#include <algorithm>
#include <cstring>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kAccess = 0x00, kKey = 0x04, kStatus = 0x0C, kControl = 0x10, kAddress = 0x14,
                        kOptions = 0x1C, kProtection = 0x20;
constexpr std::uint32_t kProgram = 1, kPageErase = 2, kMassErase = 4, kStart = 1U << 6, kLock = 1U << 7,
                        kErrorInterrupt = 1U << 10, kEndInterrupt = 1U << 12;
constexpr std::uint32_t kProgramError = 1U << 2, kEnd = 1U << 5;
constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
constexpr double kProgram_s = 52.5e-6, kErase_s = 20e-3;
constexpr unsigned kInterruptLine = 4;

}  // namespace

void FlashInterface::reset() {
  access_ = 0x30;
  status_ = address_ = 0;
  control_ = kLock;
  keys_ = 0;
  is_barred_ = false;
  if (on_timing) on_timing();
  updateLines();
}

std::uint32_t FlashInterface::read(std::uint32_t offset) {
  switch (offset) {
    case kAccess:
      return access_ | ((access_ & 0x10U) << 1);
    case kStatus:
      return status_;
    case kControl:
      return control_;
    case kAddress:
      return address_;
    case kOptions:
      return 0x03FFFFFC;
    case kProtection:
      return 0xFFFFFFFF;
    default:
      return 0;
  }
}

void FlashInterface::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kAccess:
      access_ = value & 0x1FU;
      if (on_timing) on_timing();
      return;
    case kKey:
      return unlock(value);
    case kStatus:
      status_ &= ~value;
      break;
    case kControl:
      if ((control_ & kLock) != 0) return;
      control_ = value & 0x17F7U;
      if ((control_ & (0x30U)) != 0) present_.refuse("the firmware changes option bytes of the flash");
      if ((control_ & kLock) != 0) keys_ = 0;
      if ((control_ & kStart) != 0) erase();
      break;
    case kAddress:
      address_ = value;
      break;
    default:
      break;
  }
  updateLines();
}

void FlashInterface::unlock(std::uint32_t key) {
  if (is_barred_ || keys_ >= 2 || key != kKeys[keys_]) {
    is_barred_ = true;  // Until the next reset, as after any wrong key.
    control_ |= kLock;
    return;
  }
  if (++keys_ == 2) control_ &= ~kLock;
}

void FlashInterface::erase() {
  control_ &= ~kStart;
  std::uint32_t offset = 0;
  auto bytes = static_cast<std::uint32_t>(flash_.size());
  if ((control_ & kMassErase) == 0) {
    if ((control_ & kPageErase) == 0) return;
    offset = (address_ - kFlashBase) / page_bytes_ * page_bytes_;
    bytes = page_bytes_;
  }
  if (offset >= flash_.size()) return;
  std::fill_n(flash_.begin() + offset, bytes, std::uint8_t{0xFF});
  present_.cycle += time_.cyclesIn(kErase_s);
  status_ |= kEnd;
  if (on_erase) on_erase(offset, bytes);
}

bool FlashInterface::program(std::uint32_t offset, unsigned bytes, std::uint32_t value) {
  if (bytes != 2 || (offset & 1U) != 0) return false;
  if ((control_ & kProgram) == 0 || (control_ & kLock) != 0) {
    status_ |= kProgramError;
    updateLines();
    return true;
  }
  std::uint16_t before = 0;
  std::memcpy(&before, flash_.data() + offset, sizeof before);
  const auto wanted = static_cast<std::uint16_t>(value);
  if (before != 0xFFFF && wanted != 0) {
    status_ |= kProgramError;
  } else {
    std::memcpy(flash_.data() + offset, &wanted, sizeof wanted);
    present_.cycle += time_.cyclesIn(kProgram_s);
    status_ |= kEnd;
  }
  updateLines();
  return true;
}

void FlashInterface::updateLines() {
  const bool is_up = ((status_ & kEnd) != 0 && (control_ & kEndInterrupt) != 0) ||
                     ((status_ & kProgramError) != 0 && (control_ & kErrorInterrupt) != 0);
  nvic_.setLine(kInterruptLine, is_up);
}

}  // namespace kerfbench::cortex_m_child

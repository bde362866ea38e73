// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "hil/source/cortex_m_child/device.h"

namespace kerfbench::cortex_m_child {

/// Packet memory of the USB device (STMicroelectronics 2015 RM0008, 23.3): 512 bytes, of which the core sees
/// each half-word in the low half of a word of its own. A reset leaves it as it is.
class UsbPacketMemory final : public Device {
 public:
  static constexpr std::uint32_t kBytes = 512;

  std::uint32_t read(std::uint32_t offset) override { return words_[offset / 4 % words_.size()]; }
  void write(std::uint32_t offset, std::uint32_t value) override {
    words_[offset / 4 % words_.size()] = static_cast<std::uint16_t>(value);
  }
  void reset() override {}

  /// A half-word as the USB sees it. @param address even, below kBytes.
  [[nodiscard]] std::uint16_t half(std::uint32_t address) const { return words_.at(address / 2); }
  void setHalf(std::uint32_t address, std::uint16_t value) { words_.at(address / 2) = value; }
  /// A byte as the USB sees it. @param address below kBytes.
  [[nodiscard]] std::uint8_t byte(std::uint32_t address) const {
    return static_cast<std::uint8_t>(half(address) >> (8 * (address & 1U)));
  }
  void setByte(std::uint32_t address, std::uint8_t value) {
    const unsigned shift = 8 * (address & 1U);
    setHalf(address,
            static_cast<std::uint16_t>((half(address) & ~(0xFFU << shift)) | unsigned{value} << shift));
  }

 private:
  std::array<std::uint16_t, kBytes / 2> words_{};
};

}  // namespace kerfbench::cortex_m_child

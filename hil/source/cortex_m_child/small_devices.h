// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hil/source/cortex_m_child/device.h"
#include "hil/source/cortex_m_child/parts.h"

namespace kerfbench::cortex_m_child {

/// Registers that keep what is written to them: power control and backup domain, of which nothing that
/// firmware sets there changes what pins do. A reset does not clear them.
class KeptRegisters final : public Device {
 public:
  std::uint32_t read(std::uint32_t offset) override { return words_[offset / 4 % words_.size()]; }
  void write(std::uint32_t offset, std::uint32_t value) override {
    words_[offset / 4 % words_.size()] = value;
  }
  void reset() override {}

 private:
  std::array<std::uint32_t, 256> words_{};
};

/// CRC unit (STMicroelectronics 2015 RM0008, chapter 4): the polynomial of Ethernet over words.
class CrcUnit final : public Device {
 public:
  std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

 private:
  std::uint32_t sum_{0xFFFFFFFF};
  std::uint32_t free_{};
};

/// What the part says of itself in its system memory: size of the flash, and a number that is unique on
/// silicon and the same in each run here.
void writeIdentity(const Part& part, std::span<std::uint8_t> system_memory);

}  // namespace kerfbench::cortex_m_child

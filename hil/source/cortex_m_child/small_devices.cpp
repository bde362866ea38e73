// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/small_devices.h"

#include <cstring>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kPolynomial = 0x04C11DB7;
constexpr std::size_t kFlashSizeAt = 0x7E0, kUniqueAt = 0x7E8;

}  // namespace

std::uint32_t CrcUnit::read(std::uint32_t offset) {
  if (offset == 0) return sum_;
  return offset == 4 ? free_ : 0;
}

void CrcUnit::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 4) free_ = value & 0xFFU;
  if (offset == 8 && (value & 1U) != 0) sum_ = 0xFFFFFFFF;
  if (offset != 0) return;
  sum_ ^= value;
  for (int bit = 0; bit < 32; ++bit) sum_ = (sum_ << 1) ^ ((sum_ & 0x80000000U) != 0 ? kPolynomial : 0U);
}

void CrcUnit::reset() {
  sum_ = 0xFFFFFFFF;
  free_ = 0;
}

void writeIdentity(const Part& part, std::span<std::uint8_t> system_memory) {
  const auto kibibytes = static_cast<std::uint16_t>(part.flash_bytes / 1024);
  std::memcpy(system_memory.data() + kFlashSizeAt, &kibibytes, sizeof kibibytes);
  const std::array<std::uint32_t, 3> unique{0x4B455246, 0x42454E43, 0x48000001};
  std::memcpy(system_memory.data() + kUniqueAt, unique.data(), sizeof unique);
}

}  // namespace kerfbench::cortex_m_child

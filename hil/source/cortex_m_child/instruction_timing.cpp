// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/instruction_timing.h"

#include <bit>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint8_t kBarrierCycles = 3;
constexpr std::uint8_t kPc = 15;

Timing plain(unsigned cycles, std::uint8_t flags = 0) {
  return {static_cast<std::uint8_t>(cycles), Timing::kNoRegister, Timing::kNoRegister, flags};
}

Timing load(unsigned target, unsigned base) {
  return {2, static_cast<std::uint8_t>(target), static_cast<std::uint8_t>(base), Timing::kPipelines};
}

/// A store whose offset is a number takes one cycle: the write is done while the next instruction runs.
Timing store(unsigned base, bool has_register_offset) {
  if (!has_register_offset) return plain(1);
  return {2, Timing::kNoRegister, static_cast<std::uint8_t>(base), Timing::kPipelines};
}

Timing several(unsigned registers) { return plain(1 + static_cast<unsigned>(std::popcount(registers))); }

Timing hint(unsigned operation) {
  const bool sleeps_or_wakes = operation >= 2 && operation <= 4;
  return plain(1, sleeps_or_wakes ? Timing::kTrap : 0);
}

Timing miscellaneous16(std::uint32_t code) {
  if ((code & 0xFF0FU) == 0xBF00U) return hint(code >> 4 & 0xFU);
  if ((code & 0xF600U) == 0xB400U) return several(code & 0x1FFU);
  if ((code & 0xFFE0U) == 0xB660U || (code & 0xFF00U) == 0xBE00U) return plain(1, Timing::kTrap);
  return plain(1);
}

Timing timing16(std::uint32_t code) {
  const unsigned low = code & 7U;
  const unsigned base = code >> 3 & 7U;
  const bool is_load = (code & 0x0800U) != 0;
  switch (code >> 12) {
    case 4:
      return is_load ? load(code >> 8 & 7U, Timing::kNoRegister) : plain(1);
    case 5:
      return (code >> 9 & 7U) < 3 ? store(base, true) : load(low, base);
    case 6:
    case 7:
    case 8:
      return is_load ? load(low, base) : store(base, false);
    case 9:
      return is_load ? load(code >> 8 & 7U, 13) : store(13, false);
    case 11:
      return miscellaneous16(code);
    case 12:
      return several(code & 0xFFU);
    case 13:
      return plain(1, (code & 0xFF00U) == 0xDF00U ? Timing::kTrap : 0);
    default:
      return plain(1);
  }
}

Timing tableOrDual(std::uint32_t first, std::uint32_t second) {
  if ((first & 0xFFF0U) == 0xE8D0U && (second & 0xFFE0U) == 0xF000U) return plain(2);
  const bool is_exclusive = (first & 0x0120U) == 0;
  return plain(is_exclusive ? 2 : 3);
}

Timing control(std::uint32_t first, std::uint32_t second) {
  const bool is_branch = (second & 0x5000U) != 0 || (first & 0x0380U) != 0x0380U;
  if (is_branch) return plain(1);
  if ((first & 0xFFE0U) == 0xF380U || (first & 0xFFE0U) == 0xF3E0U) return plain(1, Timing::kTrap);
  if (first == 0xF3AFU) return hint(second & 0xFFU);
  return plain(first == 0xF3BFU ? kBarrierCycles : 1);
}

Timing single(std::uint32_t first, std::uint32_t second) {
  const unsigned base = first & 0xFU;
  const unsigned target = second >> 12;
  const bool has_number = (first & 0x0080U) != 0 || (second & 0x0800U) != 0;
  if ((first & 0x0010U) == 0) return store(base, !has_number);
  const bool is_word = (first & 0x0060U) == 0x0040U;
  if (target == kPc && !is_word) return plain(1);  // PLD
  return load(target, base);
}

Timing multiply(std::uint32_t first, std::uint32_t second) {
  if ((first & 0x0080U) == 0) return plain(second >> 12 == 15 ? 1 : 2);
  constexpr std::uint8_t kCycles[8] = {4, 7, 4, 7, 5, 1, 5, 1};
  return plain(kCycles[first >> 4 & 7U]);
}

Timing timing32(std::uint32_t first, std::uint32_t second) {
  if ((first & 0xFE40U) == 0xE800U) return several(second);
  if ((first & 0xFE40U) == 0xE840U) return tableOrDual(first, second);
  if ((first & 0xF800U) == 0xF000U) return (second & 0x8000U) != 0 ? control(first, second) : plain(1);
  if ((first & 0xFE00U) == 0xF800U) return single(first, second);
  if ((first & 0xFF00U) == 0xFB00U) return multiply(first, second);
  return plain(1);
}

}  // namespace

Timing timingOf(std::uint16_t first, std::uint16_t second) {
  return isWide(first) ? timing32(first, second) : timing16(first);
}

}  // namespace kerfbench::cortex_m_child

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "hil/source/cortex_m_child/operation.h"
#include "hil/source/emulator/pattern.h"

namespace kerfbench::cortex_m_child {

using emulator::Pattern;

/// An instruction that is being decoded: its fields by letter, and where it is.
struct Encoding {
  const Pattern& pattern;
  std::uint32_t code{};
  std::uint32_t pc{};
  bool in_if_then{};
  bool ends_if_then{};  ///< The last one that an IT makes conditional.
  Processor& processor;

  [[nodiscard]] std::uint32_t operator[](char letter) const { return pattern.field(letter, code); }
  [[nodiscard]] std::uint8_t reg(char letter) const { return static_cast<std::uint8_t>((*this)[letter]); }
  /// What an instruction reads of the PC, and Align(PC, 4).
  [[nodiscard]] std::uint32_t readPc() const { return pc + 4; }
  [[nodiscard]] std::uint32_t alignedPc() const { return (pc + 4) & ~3U; }
  /// Whether a branch may be here: not between an IT and the last that depends on it.
  [[nodiscard]] bool mayBranch() const { return !in_if_then || ends_if_then; }
};

/// A line of the tables of encodings. `build` sets handler and operands; false says that the encoding is
/// UNPREDICTABLE or UNDEFINED. The first line that matches counts.
struct EncodingRow {
  Pattern pattern;
  bool (*build)(const Encoding& e, Operation& op);
};

std::span<const EncodingRow> dataProcessingRows();
std::span<const EncodingRow> arithmeticRows();
std::span<const EncodingRow> singleAccessRows();
std::span<const EncodingRow> multipleAccessRows();
std::span<const EncodingRow> branchRows();
std::span<const EncodingRow> systemRows();

/// The targets of a direct branch; one that leads out of all memory is found when it is taken.
void setBranch(const Encoding& e, Operation& op, std::uint32_t target, Handler inside, Handler outside);

/// SP and PC, which most instructions must not name.
[[nodiscard]] constexpr bool isSpOrPc(std::uint32_t number) { return number == 13 || number == 15; }
[[nodiscard]] constexpr std::uint32_t signExtended(std::uint32_t value, unsigned bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return (value ^ sign) - sign;
}

}  // namespace kerfbench::cortex_m_child

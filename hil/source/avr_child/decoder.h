// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "hil/source/avr_child/processor.h"
#include "hil/source/emulator/pattern.h"

namespace kerfbench::avr_child {

/// An instruction that is being decoded: its fields by letter, and where it is.
struct Encoding {
  const emulator::Pattern& pattern;
  std::uint32_t code{};  ///< One word, or two with the first above.
  std::uint32_t pc{};    ///< In bytes.
  const Processor& processor;

  [[nodiscard]] std::uint32_t operator[](char letter) const { return pattern.field(letter, code); }
  [[nodiscard]] std::uint8_t reg(char letter) const { return static_cast<std::uint8_t>((*this)[letter]); }
  /// The bit that a field names.
  [[nodiscard]] std::uint8_t mask(char letter) const {
    return static_cast<std::uint8_t>(1U << (*this)[letter]);
  }
  [[nodiscard]] std::int32_t signedField(char letter, unsigned bits) const {
    const std::uint32_t sign = 1U << (bits - 1);
    return static_cast<std::int32_t>((*this)[letter] ^ sign) - static_cast<std::int32_t>(sign);
  }
};

/// A line of the tables of encodings. `build` sets handler and operands; false leaves the instruction to
/// simavr.
struct EncodingRow {
  emulator::Pattern pattern;
  bool (*build)(const Encoding& e, Operation& op);
};

/// Instructions that calculate, that move data, and that change the way of the program.
std::span<const EncodingRow> arithmeticRows();
std::span<const EncodingRow> bitRows();
std::span<const EncodingRow> accessRows();
std::span<const EncodingRow> registerAccessRows();
std::span<const EncodingRow> branchRows();

/// Words of the instruction that begins with this one.
[[nodiscard]] unsigned wordsOf(std::uint32_t first);
/// Words of the instruction behind this one, which has one word.
[[nodiscard]] unsigned wordsBehind(const Encoding& e);

}  // namespace kerfbench::avr_child

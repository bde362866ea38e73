// SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace kerfbench::emulator {

/// The bits of an encoding as a manual writes them, "010001 00 D mmmm ddd": 0 and 1 must be so, letters
/// are fields, whose bits may be apart, and blanks are for the reader. Of 16 bits or of 32.
class Pattern {
 public:
  consteval Pattern(const char* text) {  // NOLINT(google-explicit-constructor): a table of texts.
    for (const char c : std::string_view(text)) {
      if (c == ' ') continue;
      for (Letter& letter : letters_) letter.bits <<= 1U;
      mask_ = mask_ << 1U | (c == '0' || c == '1' ? 1U : 0U);
      value_ = value_ << 1U | (c == '1' ? 1U : 0U);
      if (c != '0' && c != '1') add(c);
      ++width_;
    }
  }

  [[nodiscard]] constexpr bool matches(std::uint32_t code, unsigned width) const {
    return width == width_ && (code & mask_) == value_;
  }

  /// The bits of a letter in an instruction, closed up.
  [[nodiscard]] constexpr std::uint32_t field(char name, std::uint32_t code) const {
    std::uint32_t value = 0;
    for (const Letter& letter : letters_) {
      if (letter.name != name) continue;
      for (unsigned bit = 32; bit-- > 0;) {
        if ((letter.bits >> bit & 1U) != 0) value = value << 1U | (code >> bit & 1U);
      }
    }
    return value;
  }

 private:
  struct Letter {
    char name{};
    std::uint32_t bits{};
  };

  consteval void add(char c) {
    for (Letter& letter : letters_) {
      if (letter.name != c && letter.name != 0) continue;
      letter.name = c;
      letter.bits |= 1U;
      return;
    }
    throw "more fields than a pattern has place for";
  }

  std::uint32_t mask_{};
  std::uint32_t value_{};
  unsigned width_{};
  std::array<Letter, 8> letters_{};
};

}  // namespace kerfbench::emulator

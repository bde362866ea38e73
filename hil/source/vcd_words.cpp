// SPDX-License-Identifier: Apache-2.0
#include "hil/source/vcd_words.h"

#include <fmt/format.h>

#include <charconv>

namespace kerfbench::source {

std::string vcdWords(std::string_view text) {
  std::string words;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const bool lone_blank = c == ' ' && i > 0 && i + 1 < text.size() && text[i - 1] != ' ';
    const bool plain = c > ' ' && c != 0x7f && c != '$' && c != '%';
    words += plain || lone_blank ? std::string(1, text[i]) : fmt::format("%{:02X}", c);
  }
  return words;
}

std::optional<std::string> fromVcdWords(std::string_view words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != '%') {
      text += words[i];
      continue;
    }
    if (i + 2 >= words.size()) return std::nullopt;
    unsigned char c = 0;
    const char* const end = words.data() + i + 3;
    const auto done = std::from_chars(words.data() + i + 1, end, c, 16);
    if (done.ec != std::errc{} || done.ptr != end) return std::nullopt;
    text += static_cast<char>(c);
    i += 2;
  }
  return text;
}

}  // namespace kerfbench::source

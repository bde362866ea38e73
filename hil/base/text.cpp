// SPDX-License-Identifier: Apache-2.0
#include "hil/base/text.h"

#include <cmath>

#include <fmt/format.h>

#include "hil/base/utf8.h"

namespace kerfbench::base {
std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lowered(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::string printable(std::string_view text, std::size_t most_bytes) {
  std::string out;
  std::size_t taken = 0;
  while (taken < text.size()) {
    const std::size_t known = characterBytes(text.substr(taken));
    const std::size_t bytes = known == 0 ? 1 : known;
    if (taken + bytes > most_bytes) return out + "…";
    const std::string_view character = text.substr(taken, bytes);
    taken += bytes;
    if (known == 0 || isControl(character)) {
      out += '?';
    } else {
      out += character;
    }
  }
  return out;
}

std::string inQuotes(std::string_view text) { return "'" + printable(text) + "'"; }

std::string escapeHtml(std::string_view foreign) {
  const std::string text = markupText(foreign);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string hundredths(double value) {
  return fmt::format("{:.2f}", std::round(100.0 * value) / 100.0 + 0.0);
}

}  // namespace kerfbench::base

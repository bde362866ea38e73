// SPDX-License-Identifier: Apache-2.0
#include "hil/base/text.h"

#include <cmath>

#include <fmt/format.h>

namespace kerfbench::base {
namespace {

unsigned byteAt(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Bytes of the character at the begin of `text`, 0 where there is no well-formed one (RFC 3629).
std::size_t characterBytes(std::string_view text) {
  const unsigned lead = byteAt(text, 0);
  if (lead < 0x80) return 1;
  const std::size_t bytes = lead >= 0xf0 ? 4 : (lead >= 0xe0 ? 3 : 2);
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return 0;
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byteAt(text, i) & 0xc0U) != 0x80) return 0;
  }
  const unsigned second = byteAt(text, 1);
  const bool overlong = (lead == 0xe0 && second < 0xa0) || (lead == 0xf0 && second < 0x90);
  const bool no_character = (lead == 0xed && second > 0x9f) || (lead == 0xf4 && second > 0x8f);
  return overlong || no_character ? 0 : bytes;
}

/// Whether a terminal would obey the character: C0, DEL, C1.
bool isControl(std::string_view character) {
  const unsigned lead = byteAt(character, 0);
  return lead < 0x20 || lead == 0x7f || (lead == 0xc2 && byteAt(character, 1) < 0xa0);
}

}  // namespace

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

std::string escapeHtml(std::string_view text) {
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

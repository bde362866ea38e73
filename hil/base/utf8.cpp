// SPDX-License-Identifier: Apache-2.0
#include "hil/base/utf8.h"

namespace kerfbench::base {
namespace {

unsigned byteAt(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

}  // namespace

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

bool isControl(std::string_view character) {
  const unsigned lead = byteAt(character, 0);
  return lead < 0x20 || lead == 0x7f || (lead == 0xc2 && character.size() > 1 && byteAt(character, 1) < 0xa0);
}

bool hasControl(std::string_view text) {
  while (!text.empty()) {
    const std::size_t known = characterBytes(text);
    if (known != 0 && isControl(text)) return true;
    text.remove_prefix(known == 0 ? 1 : known);
  }
  return false;
}

std::string markupText(std::string_view text) {
  constexpr std::string_view kReplacement = "\xef\xbf\xbd";
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t known = characterBytes(text);
    const std::string_view character = text.substr(0, known == 0 ? 1 : known);
    const bool kept_control = character == "\n" || character == "\t" || character == "\r";
    const bool is_none = character == "\xef\xbf\xbe" || character == "\xef\xbf\xbf";
    const bool is_fit = known != 0 && !is_none && (kept_control || !isControl(character));
    out += is_fit ? character : kReplacement;
    text.remove_prefix(character.size());
  }
  return out;
}

}  // namespace kerfbench::base

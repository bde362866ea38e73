// SPDX-License-Identifier: Apache-2.0
#include "hil/base/terminal.h"

#include <array>
#include <cstddef>

#include <fmt/format.h>

#include "hil/base/utf8.h"

namespace kerfbench::base {
namespace {

// GitHub takes "##[" anywhere in a line, Azure "##vso[", TeamCity "##teamcity[".
constexpr std::array<std::string_view, 3> kObeyedAnywhere{"##[", "##vso[", "##teamcity["};

bool isObeyedHere(std::string_view text) {
  for (const std::string_view command : kObeyedAnywhere)
    if (text.starts_with(command)) return true;
  return false;
}

}  // namespace

std::string forTerminal(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  bool at_begin = true;  // Nothing but blanks stands before it in the line.
  while (!text.empty()) {
    if (at_begin && text.starts_with("::")) {
      out += ": :";
      text.remove_prefix(2);
      at_begin = false;
      continue;
    }
    if (isObeyedHere(text)) {
      out += "# ";
      text.remove_prefix(1);
      continue;
    }
    const std::size_t known = characterBytes(text);
    const std::string_view character = text.substr(0, known == 0 ? 1 : known);
    const bool is_kept = character == "\n" || character == "\t" || (known != 0 && !isControl(character));
    out += is_kept ? character : "?";
    at_begin = character == "\n" || (at_begin && (character == " " || character == "\t"));
    text.remove_prefix(character.size());
  }
  return out;
}

std::string jsonForTerminal(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  while (!json.empty()) {
    const std::size_t known = characterBytes(json);
    const std::string_view character = json.substr(0, known == 0 ? 1 : known);
    if (isObeyedHere(json)) {
      out += "\\u0023";
    } else if (character == "\n" || known > 2 || (known == 1 && !isControl(character))) {
      out += character;
    } else if (known == 2 && isControl(character)) {
      out += fmt::format("\\u00{:02x}", static_cast<unsigned char>(character[1]));
    } else if (character == "\x7f") {
      out += "\\u007f";
    } else {
      out += known == 2 ? character : "?";
    }
    json.remove_prefix(character.size());
  }
  return out;
}

void toTerminalAsItIs(std::FILE* stream, std::string_view text) {
  (void)std::fwrite(text.data(), 1, text.size(), stream);
}

void toTerminal(std::FILE* stream, std::string_view text) { toTerminalAsItIs(stream, forTerminal(text)); }

}  // namespace kerfbench::base

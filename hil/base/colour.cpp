// SPDX-License-Identifier: Apache-2.0
#include "hil/base/colour.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::base {
namespace {

ColourChoice chosen = ColourChoice::kAuto;

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

const char* codeOf(Colour colour) {
  switch (colour) {
    case Colour::kGreen:
      return "32";
    case Colour::kRed:
      return "31";
    case Colour::kYellow:
      return "33";
    case Colour::kMagenta:
      return "35";
    case Colour::kBold:
      break;
  }
  return "1";
}

}  // namespace

void chooseColour(ColourChoice choice) { chosen = choice; }

bool isColoured(std::FILE* stream) {
  if (chosen != ColourChoice::kAuto) return chosen == ColourChoice::kAlways;
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return !isSet("NO_COLOR") && !dumb && ::isatty(::fileno(stream)) == 1;
}

std::string withVerdictsInColour(const std::string& line, std::FILE* stream) {
  if (!isColoured(stream)) return line;
  constexpr std::array<std::pair<std::string_view, Colour>, 4> kVerdicts{{{"PASS", Colour::kGreen},
                                                                          {"FAIL", Colour::kRed},
                                                                          {"INVALID", Colour::kMagenta},
                                                                          {"NOT PROVEN", Colour::kYellow}}};
  const auto isLetter = [&](std::size_t at) {
    return at < line.size() && std::isalnum(static_cast<unsigned char>(line[at])) != 0;
  };
  std::string out;
  for (std::size_t at = 0; at < line.size();) {
    const auto verdict = std::ranges::find_if(kVerdicts, [&](const auto& each) {
      return line.compare(at, each.first.size(), each.first) == 0 && !isLetter(at + each.first.size()) &&
             (at == 0 || !isLetter(at - 1));
    });
    if (verdict == kVerdicts.end()) {
      out += line[at++];
    } else {
      out += inColour(std::string(verdict->first), verdict->second, stream);
      at += verdict->first.size();
    }
  }
  return out;
}

std::string inColour(const std::string& text, Colour colour, std::FILE* stream) {
  return isColoured(stream) ? fmt::format("\x1b[{}m{}\x1b[0m", codeOf(colour), text) : text;
}

}  // namespace kerfbench::base

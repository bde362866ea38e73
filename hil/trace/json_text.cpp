// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/json_text.h"

#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace kerfbench::trace {
namespace {

constexpr std::array<double, 10> kPowers{1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/// Length of a character of UTF-8 at the begin of a text; 0: it is none.
std::size_t utf8Length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80        ? 1
                             : first >> 5U == 6  ? 2
                             : first >> 4U == 14 ? 3
                             : first >> 3U == 30 ? 4
                                                 : 0;
  if (length == 0 || length > text.size()) return 0;
  unsigned value = length == 1 ? first : first & 0x7FU >> length;
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if (next >> 6U != 2) return 0;
    value = value << 6U | (next & 0x3FU);
  }
  constexpr std::array<unsigned, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = value >= 0xD800 && value <= 0xDFFF;
  return value < kLeast.at(length) || value > 0x10FFFF || is_surrogate ? 0 : length;
}

}  // namespace

void appendInteger(std::string& text, std::int64_t value) {
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

void appendNumber(std::string& text, double value, int decimals) {
  const double scaled = std::round(value * kPowers.at(static_cast<std::size_t>(decimals)));
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  constexpr double kMostExact = 9.0e18;
  if (std::abs(scaled) > kMostExact) {
    text += fmt::format("{}", value);
    return;
  }
  auto whole = static_cast<std::uint64_t>(std::abs(scaled));
  if (scaled < 0.0) text.push_back('-');
  while (decimals > 0 && whole % 10 == 0) {
    whole /= 10;
    --decimals;
  }
  const auto unit = static_cast<std::uint64_t>(kPowers.at(static_cast<std::size_t>(decimals)));
  appendInteger(text, static_cast<std::int64_t>(whole / unit));
  if (decimals == 0) return;
  text.push_back('.');
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), whole % unit).ptr;
  text.append(static_cast<std::size_t>(decimals) - static_cast<std::size_t>(end - digits.data()), '0');
  text.append(digits.data(), end);
}

void appendQuoted(std::string& text, std::string_view value) {
  text.push_back('"');
  while (!value.empty()) {
    const std::size_t length = utf8Length(value);
    const char c = value[0];
    if (length == 0) {
      text += "\xEF\xBF\xBD";
    } else if (c == '"' || c == '\\') {
      text.push_back('\\');
      text.push_back(c);
    } else if (length == 1 && static_cast<unsigned char>(c) < 0x20) {
      text += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      text += value.substr(0, length);
    }
    value.remove_prefix(length == 0 ? 1 : length);
  }
  text.push_back('"');
}

void appendTimestamp(std::string& text, std::uint64_t time_ns) {
  constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  text += fmt::format(R"("timestamp":{{"sec":{},"nsec":{}}})", time_ns / kSecond_ns, time_ns % kSecond_ns);
}

void appendColumn(std::string& text, std::string_view name, const JsonColumn& column) {
  if (text.back() != '{') text.push_back(',');
  appendQuoted(text, name);
  text += ":[";
  text += column.values();
  text.push_back(']');
}

}  // namespace kerfbench::trace

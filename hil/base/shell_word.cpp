// SPDX-License-Identifier: Apache-2.0
#include "hil/base/shell_word.h"

#include <cstddef>

#include <fmt/format.h>

#include "hil/base/utf8.h"

namespace kerfbench::base {
namespace {

constexpr std::string_view kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789@%+=:,./_-";

/// Between single quotes; a quote of its own ends them, and begins them anew.
std::string quoted(std::string_view word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string shellWord(std::string_view word) {
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  if (!hasControl(word) && markupText(word) == word) return quoted(word);
  std::string octal;
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = kPlain.find(c) != std::string_view::npos;
    octal += is_plain ? std::string(1, c) : fmt::format("\\0{:03o}", byte);
  }
  // What a command prints loses the line feeds at its end. A '?' behind them makes a name that is not found,
  // rather than one that is taken for another.
  return fmt::format("\"$(printf %b '{}{}')\"", octal, word.ends_with('\n') ? "?" : "");
}

}  // namespace kerfbench::base

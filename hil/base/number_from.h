// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace kerfbench::base {

/// The whole of `text` as a decimal number; nothing for one that T does not hold, for blanks, a '+', or
/// anything behind it. Independent of the locale. Of a floating T also "inf" and "nan".
template <typename T>
std::optional<T> numberFrom(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return value;
}

}  // namespace kerfbench::base

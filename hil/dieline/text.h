// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <type_traits>

#include "hil/base/text.h"

namespace kerfbench::dieline {

using base::inQuotes;
using base::lowered;
using base::trimmed;

/// The whole of `text` as a number; nothing for NaN, infinity or trailing characters. Independent of the
/// locale.
template <class Number>
std::optional<Number> parsedNumber(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return value;
}

}  // namespace kerfbench::dieline

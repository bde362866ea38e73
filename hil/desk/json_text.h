// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

// Private to hil/desk.
namespace kerfbench::desk {

/// Text of an answer; bytes that are not UTF-8 become U+FFFD.
inline std::string jsonText(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A length to 1e-4 mm, the last decimal of G-code: short in text. What is no number becomes null.
inline double rounded_mm(double value_mm) { return std::round(value_mm * 1e4) / 1e4 + 0.0; }

}  // namespace kerfbench::desk

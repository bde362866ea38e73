// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace kerfbench::trace {

// JSON as it is appended to a text: without an object for each value, of which an hour of a trace has a
// billion.

/// Digits after the point.
inline constexpr int kMm = 4, kRad = 9, kSeconds = 9, kWatt = 3;

/// A number rounded to so many decimals (0 … 9), without zeros at its end; "null" for what is no number.
void appendNumber(std::string& text, double value, int decimals);
void appendInteger(std::string& text, std::int64_t value);
/// A text with its quotes. Bytes that are no UTF-8 become U+FFFD.
void appendQuoted(std::string& text, std::string_view value);

/// `"timestamp":{"sec":…,"nsec":…}`, as Foxglove's schemas have it.
void appendTimestamp(std::string& text, std::uint64_t time_ns);

/// A column of a message that holds many rows.
class JsonColumn {
 public:
  void add(double value, int decimals) {
    comma();
    appendNumber(values_, value, decimals);
  }
  void add(std::int64_t value) {
    comma();
    appendInteger(values_, value);
  }
  void clear() { values_.clear(); }
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  /// The values with commas between them.
  [[nodiscard]] std::string_view values() const { return values_; }

 private:
  void comma() {
    if (!values_.empty()) values_.push_back(',');
  }
  std::string values_;
};

/// `"name":[…]`, with a comma before it unless it is the first of its object.
void appendColumn(std::string& text, std::string_view name, const JsonColumn& column);

}  // namespace kerfbench::trace

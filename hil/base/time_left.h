// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace kerfbench::base {

/// How long a work will still take, from the share of it that is done and the time that this took. One after
/// the other may be asked about; a work is known by its name.
class TimeLeft {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Seconds left, whole and at least 1. `share` is in [0, 1]. Nullopt while there is nothing to go by: in
  /// the first second, before the first hundredth, and at the end.
  std::optional<int> after(std::string_view work, double share, Time now);

 private:
  std::string work_;
  Time begun_{};
  double begun_share_{};
};

/// The share that a word on a work's progress tells ("reading pins.vcd, 42 %"), in [0, 1]; nullopt if none.
std::optional<double> shareIn(std::string_view words);

}  // namespace kerfbench::base

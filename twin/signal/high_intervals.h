// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace kerfbench::twin {

/// When a single pin was high: 16 bytes each time. Times in s, ascending.
class HighIntervals {
 public:
  void set(double time_s, bool level) {
    if (level == level_) return;
    level_ = level;
    if (level) {
      since_s_ = time_s;
    } else {
      closed_.emplace_back(since_s_, time_s);
    }
  }
  /// All intervals so far; one that is still open ends at `now_s`.
  [[nodiscard]] std::vector<std::pair<double, double>> until(double now_s) const {
    auto intervals = closed_;
    if (level_) intervals.emplace_back(since_s_, now_s);
    return intervals;
  }

 private:
  std::vector<std::pair<double, double>> closed_;
  double since_s_{};
  bool level_{false};
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace kerfbench::twin {

/// A single pin over time: its mean over any interval, and the intervals in which it was high. Times in s,
/// ascending.
class LevelTracker {
 public:
  void set(double time_s, bool level);
  /// Share of the time in [begin, end] at which the pin was high. Intervals must be asked for in order,
  /// without overlap, and after everything up to `end_s` is known.
  double meanOver(double begin_s, double end_s);
  /// Closed intervals so far; one that is still open ends at `now_s`.
  [[nodiscard]] std::vector<std::pair<double, double>> highIntervals(double now_s) const;

 private:
  std::vector<std::pair<double, bool>> changes_;  ///< Not yet consumed by meanOver().
  std::size_t next_{0};
  bool consumed_level_{false};
  bool level_{false};
  double high_since_s_{};
  std::vector<std::pair<double, double>> high_;
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace kerfbench::twin {

/// Integrates the level of a single pin: the share of an interval in which it was high. Keeps only the
/// changes that were not queried yet. Times in s, ascending.
class LevelTracker {
 public:
  void set(double time_s, bool level);
  /// Share of the time in [begin, end] at which the pin was high. Intervals must be queried in order, without
  /// overlap, and after everything up to `end_s` is known.
  double meanOver(double begin_s, double end_s) {
    if (nextChange_s() >= end_s) return consumed_level_ ? 1.0 : 0.0;
    return meanOverChanges(begin_s, end_s);
  }
  /// First change beyond all intervals queried so far; infinity while none is known.
  [[nodiscard]] double nextChange_s() const { return next_s_; }

 private:
  struct Change {
    double time_s;
    bool level;
  };
  double meanOverChanges(double begin_s, double end_s);

  std::vector<Change> changes_;
  std::size_t next_{0};
  double next_s_{std::numeric_limits<double>::infinity()};  ///< Time of changes_[next_].
  bool consumed_level_{false};
  bool level_{false};
};

}  // namespace kerfbench::twin

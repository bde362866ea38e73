// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace kerfbench::twin {

/// A single pin as something that integrates it sees it: the share of an interval in which it was high. Keeps
/// only changes that were not asked for yet. Times in s, ascending.
class LevelTracker {
 public:
  void set(double time_s, bool level);
  /// Share of the time in [begin, end] at which the pin was high. Intervals must be asked for in order,
  /// without overlap, and after everything up to `end_s` is known.
  double meanOver(double begin_s, double end_s) {
    if (nextChange_s() >= end_s) return consumed_level_ ? 1.0 : 0.0;
    return meanOverChanges(begin_s, end_s);
  }
  /// The first change beyond all intervals asked for so far; infinity while none is known.
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

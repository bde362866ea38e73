// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/level_tracker.h"

#include <algorithm>

namespace kerfbench::twin {

void LevelTracker::set(double time_s, bool level) {
  if (level == level_) return;
  level_ = level;
  if (next_ == changes_.size()) {
    changes_.clear();
    next_ = 0;
    next_s_ = time_s;
  }
  changes_.push_back({time_s, level});
}

double LevelTracker::meanOverChanges(double begin_s, double end_s) {
  double high_s = 0.0;
  double from_s = begin_s;
  while (next_ < changes_.size() && changes_[next_].time_s < end_s) {
    const double at_s = std::max(changes_[next_].time_s, begin_s);
    if (consumed_level_) high_s += at_s - from_s;
    from_s = at_s;
    consumed_level_ = changes_[next_].level;
    ++next_;
  }
  if (consumed_level_) high_s += end_s - from_s;
  // The list is compacted from time to time: a pin that changes all the time never leaves it empty.
  constexpr std::size_t kCompactAbove = 4096;
  if (next_ > kCompactAbove) {
    changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }
  next_s_ = next_ < changes_.size() ? changes_[next_].time_s : std::numeric_limits<double>::infinity();
  return high_s / (end_s - begin_s);
}

}  // namespace kerfbench::twin

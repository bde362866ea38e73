// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/level_tracker.h"

#include <algorithm>

namespace kerfbench::twin {

void LevelTracker::set(double time_s, bool level) {
  if (level == level_) return;
  level_ = level;
  changes_.emplace_back(time_s, level);
  if (level) {
    high_since_s_ = time_s;
  } else {
    high_.emplace_back(high_since_s_, time_s);
  }
}

double LevelTracker::meanOver(double begin_s, double end_s) {
  double high_s = 0.0;
  double from_s = begin_s;
  while (next_ < changes_.size() && changes_[next_].first < end_s) {
    const double at_s = std::max(changes_[next_].first, begin_s);
    if (consumed_level_) high_s += at_s - from_s;
    from_s = at_s;
    consumed_level_ = changes_[next_].second;
    ++next_;
  }
  if (consumed_level_) high_s += end_s - from_s;
  constexpr std::size_t kCompactAbove = 4096;
  if (next_ > kCompactAbove) {
    changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }
  return high_s / (end_s - begin_s);
}

std::vector<std::pair<double, double>> LevelTracker::highIntervals(double now_s) const {
  auto intervals = high_;
  if (level_) intervals.emplace_back(high_since_s_, now_s);
  return intervals;
}

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace kerfbench::twin {

/// Times of changes that are still to be handled, s, ascending.
class EdgeQueue {
 public:
  void push(double time_s) {
    if (next_ == times_s_.size()) {
      times_s_.clear();
      next_ = 0;
    }
    times_s_.push_back(time_s);
  }
  /// Time of the first change; infinity while there is none.
  [[nodiscard]] double front_s() const {
    return next_ < times_s_.size() ? times_s_[next_] : std::numeric_limits<double>::infinity();
  }
  /// Removes the first change; there must be one.
  void pop() {
    constexpr std::size_t kCompactAbove = 4096;
    if (++next_ <= kCompactAbove) return;
    times_s_.erase(times_s_.begin(), times_s_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }

 private:
  std::vector<double> times_s_;
  std::size_t next_{0};
};

}  // namespace kerfbench::twin

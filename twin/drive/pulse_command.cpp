// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/pulse_command.h"

#include <algorithm>

namespace kerfbench::twin {

double PulseCommand::meanOver(double begin_s, double end_s) {
  const double span_s = end_s - begin_s;
  double offset = 0.0;  // Offset in steps from the position at the beginning.
  const long long at_begin = count_;
  while (next_ < edges_.size() && edges_[next_].time_s < end_s) {
    const StepEdge& edge = edges_[next_++];
    offset += edge.direction * (end_s - std::max(edge.time_s, begin_s)) / span_s;
    count_ += edge.direction;
  }
  constexpr std::size_t kCompactAbove = 4096;
  if (next_ > kCompactAbove && 2 * next_ > edges_.size()) {  // Each edge is moved once at most, on average.
    edges_.erase(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(next_));
    next_ = 0;
  }
  return (static_cast<double>(at_begin) + offset) * step_;
}

}  // namespace kerfbench::twin

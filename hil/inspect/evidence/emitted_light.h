// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "hil/inspect/evidence/evidence.h"

namespace kerfbench::inspect {

/// For how long the pins let the laser emit. The spans, by time, must outlive it.
class EmittedLight {
 public:
  explicit EmittedLight(const std::vector<Span>& spans) : spans_(spans) {
    double sum_s = 0.0;
    for (const Span& span : spans) {
      before_s_.push_back(sum_s);
      sum_s += span.to_s - span.from_s;
    }
  }
  /// Sum of all spans up to a time.
  [[nodiscard]] double until(double time_s) const {
    const auto after = std::ranges::upper_bound(spans_, time_s, {}, &Span::from_s);
    if (after == spans_.begin()) return 0.0;
    const auto last = static_cast<std::size_t>(after - spans_.begin()) - 1;
    return before_s_[last] + std::min(time_s, spans_[last].to_s) - spans_[last].from_s;
  }
  [[nodiscard]] double between(double from_s, double to_s) const { return until(to_s) - until(from_s); }

 private:
  const std::vector<Span>& spans_;
  std::vector<double> before_s_;
};

}  // namespace kerfbench::inspect

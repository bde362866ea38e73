// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/lag_meter.h"

#include <cmath>
#include <cstdlib>

namespace kerfbench::source {

void LagMeter::add(std::int64_t lag_ns, std::uint64_t at_ns) {
  ++edges_;
  squares_ += static_cast<double>(lag_ns) * static_cast<double>(lag_ns);
  if (std::abs(lag_ns) <= std::abs(worst_ns_)) return;
  worst_ns_ = lag_ns;
  worst_at_ns_ = at_ns;
}

double LagMeter::rms_ns() const {
  return edges_ == 0 ? 0.0 : std::sqrt(squares_ / static_cast<double>(edges_));
}

}  // namespace kerfbench::source

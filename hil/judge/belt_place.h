// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "hil/inspect/evidence/evidence.h"

namespace kerfbench::judge {

/// Travel of the belt at a time by its encoder, mm; `belt` by time.
inline double beltAt_mm(const std::vector<inspect::BeltEdge>& belt, double time_s) {
  const auto next = std::ranges::upper_bound(belt, time_s, {}, &inspect::BeltEdge::time_s);
  return next == belt.begin() ? 0.0 : (next - 1)->x_mm;
}

}  // namespace kerfbench::judge

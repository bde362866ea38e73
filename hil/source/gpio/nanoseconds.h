// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "twin/base/pin_event.h"

namespace kerfbench::source {

/// Ticks of edges that the kernel stamps.
inline constexpr TickRate kNanoseconds{1, 1'000'000'000};

/// The whole nanoseconds that a time (>= 0) takes.
inline std::uint64_t nanosecondsUp(double time_s) {
  return static_cast<std::uint64_t>(std::ceil(1e9 * time_s));
}

}  // namespace kerfbench::source

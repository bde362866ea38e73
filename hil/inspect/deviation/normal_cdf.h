// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace kerfbench::inspect {

// Private to this room.

/// Chance that a standard normal value lies below z.
inline double normalCdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

}  // namespace kerfbench::inspect

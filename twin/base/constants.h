// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <numbers>

namespace kerfbench {

/// A quantity that could not be measured.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTurn_rad = 2.0 * std::numbers::pi;
inline constexpr double kMetre_mm = 1e3;

}  // namespace kerfbench

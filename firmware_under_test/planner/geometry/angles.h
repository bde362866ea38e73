// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace kerfbench::planner {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDeg = std::numbers::pi / 180.0;  ///< Degree in rad.

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
// What a broken measurement states where a number should be.
#pragma once

#include <limits>

namespace kerfbench::inspect {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace kerfbench::inspect

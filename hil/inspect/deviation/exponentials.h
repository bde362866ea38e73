// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace kerfbench::inspect {

// Private to this room.

inline constexpr std::size_t kExponentials = 8;  // Number of values that are computed together.

/// Replaces each value, at most 0, by its exponential: to 4e-16 of it, the same on every processor; below
/// 1e-307 nothing is left but something as small.
void toExponentials(std::array<double, kExponentials>& values);

}  // namespace kerfbench::inspect

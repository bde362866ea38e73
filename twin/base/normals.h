// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "twin/base/random.h"

namespace kerfbench {

/// Fills `out` with standard normal values, two from each counter from `first` on (Box and Muller 1958, from
/// 32 bits each, so that none exceeds 6.7): a function of the generator and `first` alone, the same on every
/// processor. For many values; those of CounterRandom::normal() are others.
void fillNormals(const CounterRandom& random, std::uint64_t first, std::span<double> out);

}  // namespace kerfbench

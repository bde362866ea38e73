// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace kerfbench {

/// Random numbers as a pure function of (seed, stream, index): the same at any number of threads and in any
/// order of calls, and the same on every standard library. Mixing is SplitMix64's finaliser (Steele et al.
/// 2014).
class CounterRandom {
 public:
  constexpr CounterRandom(std::uint64_t seed, std::uint64_t stream)
      : key_(mix(seed + 0x9e3779b97f4a7c15ULL * (stream + 1))) {}

  [[nodiscard]] constexpr std::uint64_t bits(std::uint64_t index) const {
    return mix(key_ ^ mix(index + 0x632be59bd9b4e019ULL));
  }
  /// Uniform in [0, 1).
  [[nodiscard]] constexpr double uniform(std::uint64_t index) const {
    return static_cast<double>(bits(index) >> 11U) * 0x1.0p-53;
  }
  /// Standard normal, by Box and Muller.
  [[nodiscard]] double normal(std::uint64_t index) const {
    const double u = 1.0 - uniform(2 * index);
    const double v = uniform(2 * index + 1);
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  }

 private:
  static constexpr std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }
  std::uint64_t key_;
};

}  // namespace kerfbench

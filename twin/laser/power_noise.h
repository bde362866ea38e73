// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "twin/base/random.h"

namespace kerfbench::twin {

/// Noise with a memory, as a function of time: an Ornstein-Uhlenbeck process (Gaussian, correlation
/// exp(-|dt|/correlation_s)), exact at eight knots per correlation time and straight between them, which
/// takes 2 % off the standard deviation of a momentary value and nothing off that of slower changes.
class PowerNoise {
 public:
  /// Makes the noise; deviation >= 0, correlation_s > 0.
  PowerNoise(double deviation, double correlation_s, std::uint64_t seed);
  [[nodiscard]] bool silent() const { return deviation_ == 0.0; }
  /// Mean over [begin_s, end_s], 0 <= begin_s < end_s. Later intervals cost little, one normal number a knot;
  /// an earlier one starts again from 0.
  double meanOver(double begin_s, double end_s);

 private:
  void goTo(std::int64_t knot);
  [[nodiscard]] double at(double place) const;

  CounterRandom random_;
  double deviation_;
  double knots_per_s_;
  double keep_, fresh_;  ///< Factors from knot to knot: weight of the old value, and of the new one.
  std::int64_t knot_{-1};
  double left_{0.0}, right_{0.0};  ///< Values at knot_ and at the next; standard deviation 1.
};

}  // namespace kerfbench::twin

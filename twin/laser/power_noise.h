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
  /// deviation >= 0; correlation_s > 0.
  PowerNoise(double deviation, double correlation_s, std::uint64_t seed);
  [[nodiscard]] bool silent() const { return deviation_ == 0.0; }
  /// Mean over [begin_s, end_s], 0 <= begin_s < end_s. Going on costs little, one normal number a knot;
  /// going back starts again from 0.
  double meanOver(double begin_s, double end_s);

 private:
  void goTo(std::int64_t knot);
  [[nodiscard]] double at(double place) const;

  CounterRandom random_;
  double deviation_;
  double knots_per_s_;
  double keep_, fresh_;  ///< From knot to knot: what is left of the old, and the weight of the new.
  std::int64_t knot_{-1};
  double left_{0.0}, right_{0.0};  ///< At knot_ and at the next; standard deviation 1.
};

}  // namespace kerfbench::twin

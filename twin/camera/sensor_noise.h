// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "twin/base/random.h"

namespace kerfbench::twin {

/// Turns light into grey levels: shot noise of the electrons, read noise, rounding, saturation at 0 and 255.
///
/// A normal deviate of each pixel is drawn by its index from a table of 4096 quantiles (unit variance,
/// reach 3.7 sigma): pixels are independent, and a pixel is the same whether it is exposed alone or within
/// its row.
class SensorNoise {
 public:
  SensorNoise(double read_noise, double full_well_electrons);

  /// `light` in grey levels before noise; pixel i has the index first_index + i.
  void expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
              std::uint8_t* out) const;

 private:
  float read_variance_;
  float shot_variance_per_gray_;
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "twin/base/image_fwd.h"
#include "twin/base/random.h"

namespace kerfbench::twin {

/// Quantiles of the standard normal distribution in the middles of 4096 equal shares, scaled to unit
/// variance; they reach 3.7.
const std::array<float, 4096>& normalQuantiles();

/// Turns light into grey levels: shot noise of the electrons, read noise, rounding, saturation at 0 and at
/// the highest level.
///
/// A normal deviate of each pixel is taken by its index from a table of 4096 quantiles (unit variance, reach
/// 3.7 sigma): pixels are independent, and a pixel is the same whether it is exposed alone or within its row.
class SensorNoise {
 public:
  /// `bits`: 8, 10 or 12. Noise is in units of the 8-bit scale, whatever the depth.
  SensorNoise(double read_noise, double full_well_electrons, int bits = 8);

  /// Exposes to 8 bits. `light` is in grey levels before noise; pixel i has the index first_index + i.
  void expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
              std::uint8_t* out) const;
  /// Exposes to more than 8 bits, otherwise as for 8.
  void expose(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
              std::uint16_t* out) const;
  /// Exposes a whole picture, width * height of light, at the sensor's depth.
  [[nodiscard]] GrayImage picture(std::span<const float> light, int width, int height,
                                  const CounterRandom& random) const;

 private:
  template <typename Level>
  void exposeAs(std::span<const float> light, const CounterRandom& random, std::uint64_t first_index,
                Level* out) const;

  float read_variance_;
  float shot_variance_per_gray_;
  int bits_;
};

}  // namespace kerfbench::twin

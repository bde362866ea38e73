// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace kerfbench {

// Functions without a branch or a call, for loops over many floats that a processor then takes several at a
// time (KERFBENCH_WIDE): the same on every processor, which the library's own are not said to be.

/// exp(x) to within 1e-7 of itself; x from -87 to 87.
inline float wideExp(float x) {
  constexpr float kPerOctave = 1.44269504F;
  constexpr float kWhole = 12582912.0F;  // 1.5 * 2^23: what is added to it is rounded to a whole number.
  constexpr float kOctave = 0.693359375F;
  constexpr float kOctaveRest = -2.12194440e-4F;
  const float shifted = x * kPerOctave + kWhole;
  const float octaves = shifted - kWhole;
  const float r = x - octaves * kOctave - octaves * kOctaveRest;
  // What exceeds 1 + r is small, and so is its error.
  const float more =
      r * r * (0.5F + r * (1.0F / 6 + r * (1.0F / 24 + r * (1.0F / 120 + r * (1.0F / 720 + r / 5040)))));
  const std::uint32_t exponent = std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(kWhole);
  return (1.0F + (r + more)) * std::bit_cast<float>((exponent + 127U) << 23U);
}

/// erfc(x) to within 2e-7; |x| up to 9. The power series of erf near nought, else exp(-x²) times a series
/// (Press et al. 2007, 6.2.2).
inline float wideErfc(float x) {
  const float a = x < 0.0F ? -x : x;
  const float q = a * a;
  const float near =
      a *
      (1.12837917F +
       q * (-0.376126389F +
            q * (0.112837917F +
                 q * (-0.0268661706F +
                      q * (0.00522397763F +
                           q * (-8.54832702e-4F +
                                q * (1.20553330e-4F + q * (-1.49256504e-5F +
                                                           q * (1.64621144e-6F + q * -1.63658447e-7F)))))))));
  const float t = 1.0F / (1.0F + 0.5F * a);
  const float series =
      t *
      (1.00002368F +
       t * (0.37409196F +
            t * (0.09678418F +
                 t * (-0.18628806F +
                      t * (0.27886807F +
                           t * (-1.13520398F + t * (1.48851587F + t * (-0.82215223F + t * 0.17087277F))))))));
  const float tail = t * wideExp(-q - 1.26551223F + series);
  const float beyond = a < 1.0F ? 1.0F - near : tail;
  return x < 0.0F ? 2.0F - beyond : beyond;
}

}  // namespace kerfbench

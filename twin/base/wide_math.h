// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace kerfbench {

// Functions without a branch or a call, for loops over many floats that a processor then takes several at a
// time (KERFBENCH_WIDE): the same on every processor, which the library's own are not said to be.

/// exp(x) to within 3e-7 of itself; x from -87 to 87.
inline float wideExp(float x) {
  constexpr float kPerOctave = 1.44269504F;
  constexpr float kWhole = 12582912.0F;  // 1.5 * 2^23: what is added to it is rounded to a whole number.
  constexpr float kOctave = 0.693359375F;
  constexpr float kOctaveRest = -2.12194440e-4F;
  const float shifted = x * kPerOctave + kWhole;
  const float octaves = shifted - kWhole;
  const float r = x - octaves * kOctave - octaves * kOctaveRest;
  const float series =
      1.0F + r * (1.0F + r * (0.5F + r * (1.0F / 6 + r * (1.0F / 24 + r * (1.0F / 120 + r / 720)))));
  const std::uint32_t exponent = std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(kWhole);
  return series * std::bit_cast<float>((exponent + 127U) << 23U);
}

/// erfc(x) to within 4e-7; |x| up to 9 (Abramowitz and Stegun 1964, 7.1.26).
inline float wideErfc(float x) {
  const float a = x < 0.0F ? -x : x;
  const float t = 1.0F / (1.0F + 0.3275911F * a);
  const float tail =
      t *
      (0.254829592F + t * (-0.284496736F + t * (1.421413741F + t * (-1.453152027F + t * 1.061405429F)))) *
      wideExp(-a * a);
  return x < 0.0F ? 2.0F - tail : tail;
}

}  // namespace kerfbench

// SPDX-License-Identifier: Apache-2.0
#include "twin/base/normals.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "twin/base/constants.h"
#include "twin/base/multiversion.h"

namespace kerfbench {
namespace {

constexpr std::size_t kPairs = 64;  // Pairs that are made together.
constexpr std::uint64_t kOne = 0x3ff0000000000000ULL;
constexpr std::uint64_t kMantissa = 0x000fffffffffffffULL;

/// Uniform in [1, 2), from the lower 32 bits: without a conversion, which few processors have for several
/// whole numbers of this size at once.
inline double fromOneToTwo(std::uint64_t bits) {
  return std::bit_cast<double>(((bits & 0xffffffffULL) << 20U) | kOne);
}

/// Natural logarithm of a number in (0, 1], by the series of the inverse hyperbolic tangent about 1; the next
/// term is below 4e-13.
inline double logOf(double u) {
  const auto bits = std::bit_cast<std::uint64_t>(u);
  const double m = std::bit_cast<double>((bits & kMantissa) | kOne);
  // A whole number below 2^52 is the low part of the double 2^52 + it.
  const double exponent = std::bit_cast<double>((bits >> 52U) | 0x4330000000000000ULL) - 0x1.0p52 - 1023.0;
  const bool upper = m > std::numbers::sqrt2;
  const double x = upper ? 0.5 * m : m;
  const double s = (x - 1.0) / (x + 1.0);
  const double q = s * s;
  const double series =
      1.0 + q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9 + q * (1.0 / 11 + q * (1.0 / 13))))));
  return 2.0 * s * series + (upper ? exponent + 1.0 : exponent) * std::numbers::ln2;
}

/// Two values from each 64 random bits.
KERFBENCH_WIDE void pairUp(const std::array<std::uint64_t, kPairs>& bits, std::array<double, kPairs>& a,
                           std::array<double, kPairs>& b) {
  for (std::size_t i = 0; i < kPairs; ++i) {
    const double radius = std::sqrt(-2.0 * logOf(2.0 - fromOneToTwo(bits[i] >> 32U)));
    // A quarter of the circle, and by the two lowest bits which of the four.
    const double angle = 0.5 * kPi * (fromOneToTwo(bits[i]) - 1.5);
    const double q = angle * angle;
    const double sine =
        angle *
        (1.0 +
         q * (-1.0 / 6 +
              q * (1.0 / 120 + q * (-1.0 / 5040 +
                                    q * (1.0 / 362880 + q * (-1.0 / 39916800 + q * (1.0 / 6227020800.0)))))));
    const double cosine =
        1.0 + q * (-1.0 / 2 +
                   q * (1.0 / 24 + q * (-1.0 / 720 +
                                        q * (1.0 / 40320 + q * (-1.0 / 3628800 + q * (1.0 / 479001600.0))))));
    const double along = (bits[i] & 1U) != 0 ? -cosine : cosine;
    const bool swap = (bits[i] & 2U) != 0;
    a[i] = radius * (swap ? sine : along);
    b[i] = radius * (swap ? along : sine);
  }
}

}  // namespace

void fillNormals(const CounterRandom& random, std::uint64_t first, std::span<double> out) {
  std::array<std::uint64_t, kPairs> bits;
  std::array<double, kPairs> a;
  std::array<double, kPairs> b;
  for (std::size_t begin = 0; begin < out.size(); begin += 2 * kPairs) {
    for (std::size_t i = 0; i < kPairs; ++i) bits[i] = random.bits(first + begin / 2 + i);
    pairUp(bits, a, b);
    const std::size_t count = std::min(2 * kPairs, out.size() - begin);
    for (std::size_t i = 0; i < count; ++i) out[begin + i] = i % 2 == 0 ? a[i / 2] : b[i / 2];
  }
}

}  // namespace kerfbench

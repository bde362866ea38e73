// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/exponentials.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numbers>

#include "twin/base/multiversion.h"

namespace kerfbench::inspect {
namespace {

constexpr double kDeepest = -707.0;  // Least power whose exponential has all digits.
/// Added to a number below 2^51, leaves the nearest whole number in the lowest bits.
constexpr double kToWhole = 0x1.8p52;
// log 2 in two parts: multiples of the first, with its twelve last bits zero, are exact.
constexpr double kLog2High = 0x1.62e42fefa3000p-1;
constexpr double kLog2Low = std::numbers::ln2 - kLog2High + 0x1.abc9e3b39803fp-56;

/// Series of the exponential up to the 13th power; the next term is below 5e-18 for |r| <= log(2) / 2. Odd
/// and even powers apart: neither waits for the other.
inline double seriesAt(double r) {
  const double q = r * r;
  const double even =
      1.0 +
      q * (1.0 / 2 + q * (1.0 / 24 +
                          q * (1.0 / 720 + q * (1.0 / 40320 + q * (1.0 / 3628800 + q * (1.0 / 479001600))))));
  const double odd =
      1.0 + q * (1.0 / 6 +
                 q * (1.0 / 120 + q * (1.0 / 5040 + q * (1.0 / 362880 +
                                                         q * (1.0 / 39916800 + q * (1.0 / 6227020800.0))))));
  return even + r * odd;
}

KERFBENCH_WIDE void replaceByExponentials(std::array<double, kExponentials>& values) {
  for (double& value : values) {
    const double x = std::max(value, kDeepest);
    const double shifted = x * std::numbers::log2e + kToWhole;
    const double n = shifted - kToWhole;
    const double r = (x - n * kLog2High) - n * kLog2Low;
    // The sum's lowest bits are n, which the exponent of 2^n takes.
    const double power = std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U);
    value = power * seriesAt(r);
  }
}

}  // namespace

void toExponentials(std::array<double, kExponentials>& values) { replaceByExponentials(values); }

}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/exponentials.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace kerfbench::inspect {
namespace {

TEST(Exponentials, AgreeWithTheLibrarysToTheLastDigits) {
  for (int i = 0; i <= 10'000; ++i) {
    std::array<double, kExponentials> powers{};
    for (std::size_t k = 1; k < powers.size(); ++k)
      powers[k] = -0.07 * i - 0.01 * static_cast<double>(k) - 1e-3 * std::abs(std::sin(i));
    std::array<double, kExponentials> values = powers;
    toExponentials(values);
    EXPECT_EQ(values.front(), 1.0);
    for (std::size_t k = 0; k < powers.size(); ++k)
      ASSERT_NEAR(values[k] / std::exp(powers[k]), 1.0, 4.5e-16) << powers[k];
  }
}

TEST(Exponentials, BelowAllThatCountsAreNextToNothing) {
  std::array<double, kExponentials> values{-708.0, -710.0, -746.0, -800.0, -1e4, -1e9, -1e300, -HUGE_VAL};
  toExponentials(values);
  for (const double value : values) {
    EXPECT_GE(value, 0.0);
    EXPECT_LT(value, 1e-306);
  }
}

}  // namespace
}  // namespace kerfbench::inspect

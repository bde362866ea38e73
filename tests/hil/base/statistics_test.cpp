// SPDX-License-Identifier: Apache-2.0
#include "twin/base/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace kerfbench {
namespace {

TEST(Statistics, TheMedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(medianOf({3, 1, 2}), 2);
  EXPECT_EQ(medianOf({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(medianOf({7}), 7);
  EXPECT_TRUE(std::isnan(medianOf({})));
}

TEST(Statistics, TheUpperMedianIsOneOfTheValues) {
  EXPECT_EQ(upperMedianOf<double>({3, 1, 2}), 2.0);
  EXPECT_EQ(upperMedianOf<double>({4, 1, 2, 3}), 3.0);
  EXPECT_EQ(upperMedianOf<std::uint8_t>({200, 7}), 200);
}

TEST(Statistics, TheFactorsAreThoseOfANormalLaw) {
  // Quantile of 0.75 by bisection of the error function.
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erf(middle / std::sqrt(2.0)) < 0.5 ? low : high) = middle;
  }
  EXPECT_NEAR(kMadToSigma, 1.0 / low, 5e-5);
  EXPECT_NEAR(kMedianSquare, low * low, 5e-5);
}

}  // namespace
}  // namespace kerfbench

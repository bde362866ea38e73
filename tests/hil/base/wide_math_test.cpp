// SPDX-License-Identifier: Apache-2.0
// Functions for many floats at once, compared with the standard library's in double.
#include "twin/base/wide_math.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace kerfbench {
namespace {

TEST(WideMath, ExpIsRightToTheLastFigureOfAFloat) {
  double worst = 0.0;
  for (int i = -86'000; i <= 86'000; ++i) {
    const float x = 0.001F * static_cast<float>(i);
    const double exact = std::exp(static_cast<double>(x));
    worst = std::max(worst, std::abs(wideExp(x) - exact) / exact);
  }
  EXPECT_LT(worst, 1e-7);
  EXPECT_EQ(wideExp(0.0F), 1.0F);
}

TEST(WideMath, ErfcIsRightOnBothSidesAndWhereItsSeriesMeet) {
  double worst = 0.0;
  for (int i = -90'000; i <= 90'000; ++i) {
    const float x = 1e-4F * static_cast<float>(i);
    worst = std::max(worst, std::abs(wideErfc(x) - std::erfc(static_cast<double>(x))));
  }
  EXPECT_LT(worst, 2e-7);
  EXPECT_EQ(wideErfc(0.0F), 1.0F);
  EXPECT_NEAR(wideErfc(0.99999F), wideErfc(1.00001F), 1e-5);
}

}  // namespace
}  // namespace kerfbench

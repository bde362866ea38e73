// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_blur.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kerfbench::vision {
namespace {

TEST(BlurredProfile, HasTheWeightedMeanOfAllNeighboursInWhateverOrderItIsAsked) {
  const BlurKernel kernel(2.5, 9);
  const auto sampleAt = [](int i) { return std::sin(0.7 * i) + 0.01 * i; };
  constexpr int kSize = 37;
  BlurredProfile profile(kSize, kernel, sampleAt);
  ASSERT_EQ(profile.size(), 37U);
  for (int asked = 0; asked < kSize; ++asked) {
    const int i = 11 * asked % kSize;
    double sum = 0.0, weights = 0.0;
    for (int k = -9; k <= 9; ++k) {
      const double weight = std::exp(-0.5 * k * k / (2.5 * 2.5));
      sum += weight * sampleAt(i + k);
      weights += weight;
    }
    EXPECT_EQ(profile[static_cast<std::size_t>(i)], sum / weights) << i;
  }
}

}  // namespace
}  // namespace kerfbench::vision

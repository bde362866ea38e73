// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/gaussian_blur.h"

#include <cstddef>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
const std::vector<int> kEdgesX{0, 16, 32, 48, 64};
const std::vector<int> kEdgesY{0, 16, 32, 48};

TEST(GaussianBlur, SpreadsAPointByItsVarianceAndKeepsItsLight) {
  for (const double variance : {0.1, 0.277, 1.0, 3.9}) {
    std::vector<float> light(kWidth * kHeight, 0.0F);
    light[24 * kWidth + 31] = 1000.0F;
    std::vector<char> drawn(12, 0);
    drawn[1 * 4 + 1] = 1;
    GaussianBlur(variance).apply(light, kWidth, kHeight, kEdgesX, kEdgesY, drawn);
    double sum = 0.0, xx = 0.0, yy = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double value = static_cast<double>(light[static_cast<std::size_t>(y * kWidth + x)]);
        sum += value;
        xx += value * (x - 31) * (x - 31);
        yy += value * (y - 24) * (y - 24);
      }
    }
    EXPECT_NEAR(sum, 1000.0, 1e-2);
    EXPECT_NEAR(xx / sum, variance, 1e-3 * variance);
    EXPECT_NEAR(yy / sum, variance, 1e-3 * variance);
  }
}

TEST(GaussianBlur, LeavesAFlatPictureFlatUpToItsBorders) {
  std::vector<float> light(kWidth * kHeight, 28.0F);
  GaussianBlur(0.5).apply(light, kWidth, kHeight, kEdgesX, kEdgesY, std::vector<char>(12, 1));
  for (const float level : light) EXPECT_NEAR(level, 28.0F, 1e-4F);
}

TEST(GaussianBlur, WorkingBlockByBlockLeavesNoSeams) {
  std::vector<float> light(kWidth * kHeight);
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = static_cast<float>(i % kWidth);
  const std::vector<float> before = light;
  GaussianBlur(1.0).apply(light, kWidth, kHeight, kEdgesX, kEdgesY, std::vector<char>(12, 1));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 8; x < kWidth - 8; ++x) {
      const auto i = static_cast<std::size_t>(y * kWidth + x);
      EXPECT_NEAR(light[i], before[i], 1e-4F);
    }
  }
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
// Fit of one spot: its stated error compared with its scatter, and shapes that are no spot.
#include "hil/vision/spot/spot_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include <gtest/gtest.h>

#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr int kSide = 40;
constexpr double kBoard = 60.0;
constexpr double kBoardVariance = 4.0;
constexpr double kPerGray = 0.05;

/// A picture of light with read and shot noise; `light` gives the grey of a pixel above the board.
GrayImage picture(std::uint64_t seed, const std::function<double(const Vector2d&)>& light,
                  double per_gray = kPerGray) {
  const CounterRandom random(seed, 8);
  GrayImage image(kSide, kSide);
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      const double gray = light(Vector2d(c, r));
      const double sigma = std::sqrt(kBoardVariance + per_gray * gray);
      const double noise = sigma * random.normal(static_cast<std::uint64_t>(r * kSide + c));
      image.at(c, r) = static_cast<std::uint8_t>(std::lround(std::clamp(kBoard + gray + noise, 0.0, 255.0)));
    }
  }
  return image;
}

std::optional<SpotFit> fit(const GrayImage& image, const BrightPeak& peak) {
  return fitSpot(image, peak, kBoard, {kBoard, kBoardVariance, kPerGray});
}

TEST(SpotFit, StatesHowItsCentreScatters) {
  constexpr int kPictures = 800;
  const CounterRandom random(2, 9);
  double squares = 0.0;
  double stated = 0.0;
  for (std::uint64_t i = 0; i < kPictures; ++i) {
    const Vector2d centre(19.5 + random.uniform(2 * i), 19.5 + random.uniform(2 * i + 1));
    const GrayImage image = picture(i + 1, [&](const Vector2d& p) {
      return 150.0 * std::exp(-0.5 * (p - centre).squaredNorm() / (1.4 * 1.4));
    });
    const auto spot = fit(image, {20, 20, 140});
    ASSERT_TRUE(spot) << i;
    squares += (spot->pixel - centre).squaredNorm() / kPictures;
    stated += spot->covariance_px2.trace() / kPictures;
  }
  // The mean of 1600 squares of normal values is known to 3.5 % at one sigma.
  EXPECT_NEAR(stated / squares, 1.0, 0.14);
}

TEST(SpotFit, SpotsTellTheCamerasShotNoise) {
  // The variance is 4 on the board, and more for each grey of light; before any spot was seen it is taken for
  // 0.8 x 4 / 60 = 0.053.
  for (const double per_gray : {0.02, 0.06}) {
    ShotNoise shot;
    for (std::uint64_t i = 1; i <= 300; ++i) {
      const GrayImage image = picture(
          i,
          [&](const Vector2d& p) {
            return 150.0 * std::exp(-0.5 * (p - Vector2d(20.2, 19.7)).squaredNorm() / 2.0);
          },
          per_gray);
      const PixelNoise now = shot.on(kBoard, std::sqrt(kBoardVariance));
      EXPECT_NEAR(now.variance(kBoard), kBoardVariance, 1e-12);
      const auto spot = fitSpot(image, {20, 20, 140}, kBoard, now);
      ASSERT_TRUE(spot);
      shot.add(spot->shot);
    }
    const double bright = shot.on(kBoard, std::sqrt(kBoardVariance)).variance(kBoard + 100.0);
    EXPECT_NEAR(bright, kBoardVariance + 100.0 * per_gray, 1.0) << per_gray;
  }
}

TEST(SpotFit, OneHotPixelIsNoSpot) {
  for (const double gray : {60.0, 120.0, 190.0}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const GrayImage image =
          picture(seed, [&](const Vector2d& p) { return p == Vector2d(20, 20) ? gray : 0.0; });
      const auto spot = fit(image, {20, 20, static_cast<int>(gray / 4.0)});
      EXPECT_FALSE(spot) << gray << " seed " << seed << ": " << spot->short_sigma_px << " px wide";
    }
  }
}

TEST(SpotFit, TwoHotPixelsBesideEachOtherAreSharperThanAnyLens) {
  for (const Vector2d& other : {Vector2d(21, 20), Vector2d(20, 21)}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const GrayImage image = picture(seed, [&](const Vector2d& p) {
        return p == Vector2d(20, 20) ? 150.0 : p == other ? 120.0 : 0.0;
      });
      const auto spot = fit(image, {20, 20, 70});
      EXPECT_FALSE(spot) << "seed " << seed << ": " << spot->short_sigma_px << " px wide";
    }
  }
}

TEST(SpotFit, AnEdgeOfLightIsNoSpot) {
  const GrayImage image = picture(1, [](const Vector2d& p) { return p.x() > 19.0 ? 100.0 : 0.0; });
  EXPECT_FALSE(fit(image, {21, 20, 100}));
}

}  // namespace
}  // namespace kerfbench::vision

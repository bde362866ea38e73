// SPDX-License-Identifier: Apache-2.0
// Effect of the board's grain on a spot's centre, compared with the same weights on many pieces of board.
#include "hil/vision/spot/spot_grain.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

constexpr int kSide = 400;
constexpr double kBoard = 110.0;

/// Board with grain that runs along rows or along columns: means of three pixels in a line.
GrayImage board(bool along_rows, std::uint64_t seed) {
  const CounterRandom random(seed, 3);
  std::vector<double> white(static_cast<std::size_t>((kSide + 2) * (kSide + 2)));
  for (std::size_t i = 0; i < white.size(); ++i) white[i] = 8.0 * random.normal(i);
  GrayImage image(kSide, kSide);
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k)
        sum += white[static_cast<std::size_t>((along_rows ? r : r + k) * (kSide + 2) +
                                              (along_rows ? c + k : c))];
      image.at(c, r) = static_cast<std::uint8_t>(std::lround(kBoard + sum / 3.0));
    }
  }
  return image;
}

/// A fit whose centre follows the difference of two neighbouring blocks of pixels: x by columns, y by rows.
SpotFit spotAt(double column, double row) {
  SpotFit fit;
  fit.pixel = {column, row};
  fit.long_sigma_px = fit.short_sigma_px = 1.0;
  fit.covariance_px2 = 1e-9 * Eigen::Matrix2d::Identity();
  for (int r = -2; r <= 2; ++r) {
    for (int c = -2; c <= 2; ++c)
      fit.influences.push_back(
          {static_cast<int>(column) + c, static_cast<int>(row) + r, 0.01 * Eigen::Vector2d(c, r), 0.0});
  }
  return fit;
}

TEST(BoardGrain, MovesACentreAcrossTheGrainMoreThanAlongIt) {
  for (const bool along_rows : {true, false}) {
    SCOPED_TRACE(along_rows ? "grain along rows" : "grain along columns");
    BoardGrain grain;
    Eigen::Matrix2d truth = Eigen::Matrix2d::Zero();
    double places = 0.0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const GrayImage image = board(along_rows, seed);
      for (int row = 30; row < kSide - 30; row += 9) {
        for (int column = 30; column < kSide - 30; column += 9) {
          const SpotFit fit = spotAt(column, row);
          if (row % 4 == 0 && column % 4 == 0) grain.add(image, fit, kBoard);
          Eigen::Vector2d moved = Eigen::Vector2d::Zero();
          for (const SpotFit::Influence& i : fit.influences)
            moved += i.by_gray * (image.gray(i.column, i.row) - kBoard);
          truth += moved * moved.transpose();
          places += 1.0;
        }
      }
    }
    truth /= places;
    const Eigen::Matrix2d stated = grain.centreCovariance(spotAt(50, 50), PixelNoise{});
    // The variance of 4000 places is known to 2 %.
    EXPECT_NEAR(stated(0, 0) / truth(0, 0), 1.0, 0.12);
    EXPECT_NEAR(stated(1, 1) / truth(1, 1), 1.0, 0.12);
    const double ratio = truth(0, 0) / truth(1, 1);
    EXPECT_TRUE(along_rows ? ratio < 0.8 : ratio > 1.25) << ratio;
  }
}

TEST(BoardGrain, TheSpotsOwnLightIsNoisyToo) {
  constexpr double kPerGray = 0.1;
  constexpr double kBrighter = 150.0;
  const GrayImage image = board(true, 9);
  BoardGrain grain;
  Eigen::Matrix2d truth = Eigen::Matrix2d::Zero();
  double places = 0.0;
  const CounterRandom shot(9, 4);
  std::uint64_t draw = 0;
  for (int row = 30; row < kSide - 30; row += 7) {
    for (int column = 30; column < kSide - 30; column += 7) {
      const SpotFit fit = spotAt(column, row);
      if (row % 4 == 0 && column % 4 == 0) grain.add(image, fit, kBoard);
      Eigen::Vector2d moved = Eigen::Vector2d::Zero();
      for (const SpotFit::Influence& i : fit.influences) {
        const double light = std::sqrt(kPerGray * kBrighter) * shot.normal(draw++);
        moved += i.by_gray * (image.gray(i.column, i.row) - kBoard + light);
      }
      truth += moved * moved.transpose();
      places += 1.0;
    }
  }
  SpotFit lit = spotAt(50, 50);
  for (SpotFit::Influence& i : lit.influences) i.brighter_gray = kBrighter;
  const Eigen::Matrix2d stated = grain.centreCovariance(lit, {.per_gray = kPerGray});
  EXPECT_NEAR(stated.trace() / (truth / places).trace(), 1.0, 0.12);
}

}  // namespace
}  // namespace kerfbench::vision

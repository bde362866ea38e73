// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/image/window_scan.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

/// Board of 100 gray with a noise of 2, as a window that begins at (300, 200).
GrayImage board(std::uint64_t seed, int width = 60, int height = 50) {
  GrayImage image(width, height, 100);
  image.left = 300;
  image.top = 200;
  const CounterRandom random(seed, 1);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(std::lround(100.0 + 2.0 * random.normal(i)));
  return image;
}

void bright(GrayImage& image, int column, int row, int gray) {
  for (int r = row; r < row + 2; ++r) {
    for (int c = column; c < column + 2; ++c) image.at(c, r) = static_cast<std::uint8_t>(gray);
  }
}

TEST(WindowScan, TheBrightestPlaceIsToldByItsColumnAndRowInTheWholePicture) {
  for (const auto& [column, row] : {std::pair(300, 200), std::pair(358, 248), std::pair(331, 217)}) {
    GrayImage image = board(3);
    bright(image, column, row, 140);
    const auto peak = brightestOf(image, 100, 2.0, {});
    ASSERT_TRUE(peak) << column;
    EXPECT_EQ(peak->column, column);
    EXPECT_EQ(peak->row, row);
    EXPECT_EQ(peak->height, 40);
  }
}

TEST(WindowScan, PlainBoardHasNone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    EXPECT_FALSE(brightestOf(board(seed), 100, 2.0, {})) << seed;
}

TEST(WindowScan, WhatWasTriedIsPassedOver) {
  GrayImage image = board(5);
  bright(image, 310, 210, 200);
  bright(image, 319, 210, 150);  // Just out of reach of the first.
  bright(image, 340, 240, 130);
  std::vector<BrightPeak> tried;
  for (const int column : {310, 319, 340}) {
    const auto peak = brightestOf(image, 100, 2.0, tried);
    ASSERT_TRUE(peak) << column;
    EXPECT_EQ(peak->column, column);
    tried.push_back(*peak);
  }
  EXPECT_FALSE(brightestOf(image, 100, 2.0, tried));
}

TEST(WindowScan, LevelsAreThoseOfAllWindowsTogether) {
  std::vector<GrayImage> windows{board(7), board(8), GrayImage{}};
  EXPECT_NEAR(levelsOf(windows).noise, 2.0, 0.15);
  for (std::size_t i = 0; i < 1200; ++i) windows[0].pixels[i] = 25;  // A fifth of all is ink.
  const WindowLevels levels = levelsOf(windows);
  EXPECT_NEAR(levels.median, 100, 1);
  EXPECT_EQ(levels.saturated_share, 0.0);
  EXPECT_FALSE(levels.lifeless);
  for (std::uint8_t& pixel : windows[1].pixels) pixel = 255;
  EXPECT_NEAR(levelsOf(windows).saturated_share, 0.5, 0.01);
  EXPECT_TRUE(levelsOf(std::vector<GrayImage>{GrayImage(40, 40, 90)}).lifeless);
}

TEST(WindowScan, TheMedianOfAWindowIsItsOwn) {
  EXPECT_NEAR(medianOf(board(9)), 100, 1);
  EXPECT_EQ(medianOf(GrayImage(30, 30, 60)), 60);
  EXPECT_EQ(medianOf(GrayImage{}), 0);
}

TEST(WindowScan, AWindowOfOneRowHasNoPlace) {
  EXPECT_FALSE(brightestOf(GrayImage(40, 1, 200), 100, 2.0, {}));
}

}  // namespace
}  // namespace kerfbench::vision

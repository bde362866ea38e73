// SPDX-License-Identifier: Apache-2.0
// No place of the picture hides a spot: the search uses means of 2 x 4 pixels on every second row, where
// every other row hints at one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "hil/vision/image/brightness_scan.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/spot_twin.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kBoard = 110.0;

/// A picture with one spot, rounded to 8 bits, with noise like a camera's on request.
GrayImage pictureOf(int width, int height, const Vector2d& spot_px, double sigma_px, double gray,
                    std::uint64_t seed = 0) {
  const CounterRandom random(seed, 1);
  const auto bell = [&](double off_px) { return std::exp(-0.5 * off_px * off_px / (sigma_px * sigma_px)); };
  std::vector<double> across;
  for (int c = 0; c < width; ++c) across.push_back(bell(c - spot_px.x()));
  GrayImage image(width, height);
  for (int r = 0; r < height; ++r) {
    const double along = gray * bell(r - spot_px.y());
    for (int c = 0; c < width; ++c) {
      double value = kBoard + along * across[static_cast<std::size_t>(c)];
      const auto index =
          static_cast<std::uint64_t>(r) * static_cast<std::uint64_t>(width) + static_cast<std::uint64_t>(c);
      if (seed != 0) value += std::sqrt(0.64 + value * 0.0255) * random.normal(index);
      image.at(c, r) = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return image;
}

bool foundAt(const GrayImage& image, const Vector2d& spot_px) {
  const BrightnessScan scan = scanBrightness(image, 4);
  return std::any_of(scan.peaks.begin(), scan.peaks.end(), [&](const BrightPeak& peak) {
    return (Vector2d(peak.column + 0.5, peak.row + 0.5) - spot_px).norm() < 1.5;
  });
}

// Places at every phase of the pixels (eighths) and of the rows' pairs, around the corner where four cells
// meet, at the borders and in the corners of pictures of odd and even size. Light of the lens alone (0.6 px),
// the smallest possible, must be seen at a third of the board's grey; the model's spot (0.8 px) at a fifth.
TEST(SpotSearch, NoPlaceHidesASpot) {
  int places = 0;
  for (const auto& [width, height] : {std::pair{160, 160}, {131, 129}}) {
    std::vector<double> columns, rows;
    for (int k = 0; k <= 8; ++k) {
      for (const double base : {63.0, 64.0, 20.0, 0.0, width - 2.0}) columns.push_back(base + k / 8.0);
    }
    for (int k = 0; k <= 32; ++k) rows.push_back(62.0 + k / 8.0);
    for (int k = 0; k <= 8; ++k) {
      rows.push_back(k / 8.0);
      rows.push_back(height - 2.0 + k / 8.0);
    }
    for (const double x : columns) {
      for (const double y : rows) {
        for (const auto& [sigma_px, gray] : {std::pair{0.6, 36.0}, {0.8, 22.0}}) {
          ++places;
          ASSERT_TRUE(foundAt(pictureOf(width, height, {x, y}, sigma_px, gray), {x, y}))
              << x << " " << y << " of " << width << " x " << height << ", sigma " << sigma_px;
        }
      }
    }
  }
  std::printf("  %d places, none missed\n", places);
}

/// A spot alone on a board whose noise, as it is told by steps between samples, is that of a dark column
/// beside each of them.
GrayImage onSteppedBoard(const Vector2d& spot_px, double sigma_px, double gray, int step_gray) {
  constexpr int kWidth = 48;
  constexpr int kHeight = 80;
  constexpr int kSamplesPx = 16;
  const auto bell = [&](double off_px) { return std::exp(-0.5 * off_px * off_px / (sigma_px * sigma_px)); };
  std::array<double, kWidth> across{};
  for (int c = 0; c < kWidth; ++c) across[static_cast<std::size_t>(c)] = bell(c - spot_px.x());
  GrayImage image(kWidth, kHeight);
  for (int r = 0; r < kHeight; ++r) {
    const double along = gray * bell(r - spot_px.y());
    for (int c = 0; c < kWidth; ++c) {
      const double board = kBoard - (c % kSamplesPx == 1 ? step_gray : 0);
      image.at(c, r) = static_cast<std::uint8_t>(board + along * across[static_cast<std::size_t>(c)] + 0.5);
    }
  }
  return image;
}

/// Whether a mean of 2 x 4 pixels on every second row stands out of the board, taken pixel by pixel.
bool standsOut(const GrayImage& image) {
  const Background background(image);
  const double least = std::ceil(std::max(5.0, 2.0 * background.noise() + 1.5));
  const auto mean = [](int a, int b) { return (a + b + 1) / 2; };
  const auto square = [&](int c, int r) {
    return mean(mean(image.at(c, r), image.at(c, r + 1)), mean(image.at(c + 1, r), image.at(c + 1, r + 1)));
  };
  for (int r = 0; r + 1 < image.height; r += 2) {
    for (int c = 0; c + 1 < image.width; ++c) {
      if (mean(square(c, std::max(0, r - 2)), square(c, r)) >= background.at(c, r) + least) return true;
    }
  }
  return false;
}

// The faintest spot that all rows would show, from as sharp as 0.8 px to as wide as 4 px, at eighths of
// pixels: in a cell, where two bands of cells meet, and at the picture's borders; on a quiet board and on
// noisy ones.
TEST(SpotSearch, EveryOtherRowHintsAtAllThatTheRowsShow) {
  std::vector<double> rows;
  for (int k = 0; k <= 16; ++k) {
    for (const double base : {20.0, 62.0}) rows.push_back(base + k / 8.0);
  }
  for (int k = 0; k <= 8; ++k) {
    for (const double base : {0.0, 64.0, 78.0}) rows.push_back(base + k / 8.0);
  }
  const auto expectFaintestFound = [](const Vector2d& spot_px, double sigma_px, int step_gray) {
    double hidden = 0.0;
    double shown = 140.0;
    while (shown - hidden > 0.5) {
      const double gray = 0.5 * (hidden + shown);
      (standsOut(onSteppedBoard(spot_px, sigma_px, gray, step_gray)) ? shown : hidden) = gray;
    }
    const GrayImage faintest = onSteppedBoard(spot_px, sigma_px, shown, step_gray);
    EXPECT_FALSE(scanBrightness(faintest, 4).peaks.empty())
        << spot_px.transpose() << ", sigma " << sigma_px << " px, " << shown << " gray, steps of "
        << step_gray;
  };
  int spots = 0;
  for (const int step_gray : {0, 3, 5, 8}) {
    for (const double sigma_px : {0.8, 0.9, 1.0, 1.4, 2.0, 3.0, 4.0}) {
      for (const double row : rows) {
        for (const double column : {24.0, 24.25, 24.5, 24.625}) {
          ++spots;
          expectFaintestFound({column, row}, sigma_px, step_gray);
        }
      }
    }
  }
  std::printf("  %d spots, none missed\n", spots);
}

TEST(SpotSearch, SomethingBrighterInTheSameRowOrColumnHidesNoSpot) {
  for (const Vector2d& spot_px : {Vector2d(40.3, 300.6), Vector2d(290.1, 45.8), Vector2d(280.4, 290.2)}) {
    GrayImage image = pictureOf(340, 340, spot_px, 0.8, 40.0);
    // The glare is far from the spot but level with it, or above.
    for (int r = 20; r < 24; ++r) {
      for (int c = 20; c < 24; ++c) image.at(c, r) = 250;
    }
    EXPECT_TRUE(foundAt(image, spot_px)) << spot_px.transpose();
  }
}

TEST(SpotSearch, NoiseHidesNoSpotEither) {
  const CounterRandom random(5, 2);
  for (std::uint64_t i = 0; i < 1500; ++i) {
    const Vector2d place(1.0 + 157.0 * random.uniform(2 * i), 1.0 + 157.0 * random.uniform(2 * i + 1));
    EXPECT_TRUE(foundAt(pictureOf(160, 160, place, 0.8, 26.0, i + 1), place)) << place.transpose();
  }
}

TEST(SpotSearch, NoiseIsRarelyTakenForASpot) {
  int peaks = 0;
  for (std::uint64_t i = 0; i < 100; ++i)
    peaks += static_cast<int>(scanBrightness(pictureOf(512, 512, {0, 0}, 1.0, 0.0, i + 1), 4).peaks.size());
  std::printf("  %d peaks of noise in 100 pictures of 512 x 512\n", peaks);
  EXPECT_LE(peaks, 10);
}

TEST(SpotSearch, PicturesTooSmallForAnything) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 50}, {50, 1}, {2, 2}, {3, 65}, {65, 3}, {64, 64}, {129, 2}})
    EXPECT_TRUE(scanBrightness(GrayImage(width, height, 90), 4).peaks.empty());
}

}  // namespace
}  // namespace kerfbench::vision

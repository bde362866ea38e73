// SPDX-License-Identifier: Apache-2.0
// No place of the picture hides a spot: the search uses means of 2 x 4 pixels on every second row.
#include <algorithm>
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
  GrayImage image(width, height);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      double value =
          kBoard + gray * std::exp(-0.5 * (Vector2d(c, r) - spot_px).squaredNorm() / (sigma_px * sigma_px));
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

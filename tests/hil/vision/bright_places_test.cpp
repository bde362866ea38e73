// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/bright_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hil/vision/kerf_twin.h"
#include "twin/base/image.h"
#include "twin/base/random.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr int kCell = Background::kCellPx;

/// Board of uneven light and grain in patches, with a bright line.
TileView grainyTile(int width, int height) {
  TileView view;
  GrayImage image(width, height);
  const CounterRandom random(3, 4);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      const double scatter = c / kCell % 2 == 0 ? 2.0 : 9.0;
      const double line = std::abs(r - 20 - c / 4) < 2 ? 25.0 : 0.0;
      const double gray = 60.0 + 0.05 * c + line + scatter * random.normal(image.index(c, r));
      image.at(c, r) = static_cast<std::uint8_t>(std::clamp(gray, 0.0, 255.0));
    }
  }
  view.tile.image = image;
  view.background.emplace(image);
  view.noise_gray = view.background->noise();
  return view;
}

int sumAround(const GrayImage& image, int column, int row) {
  int sum = 0;
  for (int r = row - 1; r <= row + 1; ++r)
    for (int c = column - 1; c <= column + 1; ++c)
      sum += image.at(std::clamp(c, 0, image.width - 1), std::clamp(r, 0, image.height - 1));
  return sum;
}

/// Scatter of the means of nine in one cell: every fourth pixel, each way.
double scatterIn(const GrayImage& image, int i, int j) {
  std::vector<int> sums;
  for (int r = j * kCell; r < std::min((j + 1) * kCell, image.height); r += 4)
    for (int c = i * kCell; c < std::min((i + 1) * kCell, image.width); c += 4)
      sums.push_back(sumAround(image, c, r));
  const int middle = upperMedianOf(sums);
  for (int& sum : sums) sum = std::abs(sum - middle);
  return kMadToSigma * upperMedianOf(sums) / 9;
}

TEST(BrightPlaces, AreThoseAboveNoiseGrainAndContrastPixelByPixel) {
  constexpr int kCellsX = 4, kCellsY = 3;
  const TileView view = grainyTile(3 * kCell + 17, 2 * kCell + 5);
  const GrayImage& image = view.tile.image;
  const GrayImage places = brightPlaces(view, 250.0, 0.035);
  const auto cell = [](int i, int j) { return static_cast<std::size_t>(j * kCellsX + i); };
  std::array<double, std::size_t{kCellsX} * kCellsY> scatter{}, limit{};
  for (int j = 0; j < kCellsY; ++j)
    for (int i = 0; i < kCellsX; ++i) scatter.at(cell(i, j)) = scatterIn(image, i, j);
  for (int j = 0; j < kCellsY; ++j) {
    for (int i = 0; i < kCellsX; ++i) {
      std::vector<double> around;
      for (int y = std::max(0, j - 1); y <= std::min(kCellsY - 1, j + 1); ++y)
        for (int x = std::max(0, i - 1); x <= std::min(kCellsX - 1, i + 1); ++x)
          around.push_back(scatter.at(cell(x, y)));
      const double board = view.background->at(i * kCell, j * kCell);
      limit.at(cell(i, j)) =
          9 *
          (board + std::max({3.0 * view.noise_gray, 5.0 * upperMedianOf(around), 0.035 * (250.0 - board)}));
    }
  }
  std::size_t bright = 0;
  for (int r = 0; r < image.height; ++r) {
    for (int c = 0; c < image.width; ++c) {
      const bool expected = sumAround(image, c, r) > std::floor(limit.at(cell(c / kCell, r / kCell)));
      ASSERT_EQ(places.at(c, r), expected ? 255 : 0) << c << ", " << r;
      bright += expected ? 1U : 0U;
    }
  }
  EXPECT_GT(bright, 100U);
  EXPECT_LT(bright, image.pixels.size() / 4);
}

}  // namespace
}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
// The back light over the picture, from boards with whatever lies on them.
#include "hil/vision/kerf/kerf_light.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "hil/vision/image/brightness_scan.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr int kWidth = 1280;
constexpr int kHeight = 960;
const Vector2d kMiddle(0.5 * (kWidth - 1), 0.5 * (kHeight - 1));

/// A lamp that falls off to the right and below, behind a lens that darkens its corners.
double lamp(const Vector2d& pixel) {
  const Vector2d d = (pixel - kMiddle) / (0.5 * kWidth);
  return 1.0 - 0.2 * d.x() - 0.1 * d.y() - 0.25 * d.x() * d.x() + 0.1 * d.x() * d.y() - 0.3 * d.y() * d.y();
}

/// Board of this gray, or what `over` makes of it, in that light and with a sensor's noise.
GrayImage picture(double board, const std::function<double(int, int, double)>& over, int width = kWidth,
                  int height = kHeight) {
  GrayImage image(width, height);
  const CounterRandom random(7, 1);
  std::uint64_t next = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double gray = over(x, y, board) * lamp(Vector2d(x, y)) + 2.0 * (random.uniform(next++) - 0.5);
      image.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(gray), 0L, 255L));
    }
  }
  return image;
}

double plain(int, int, double board) { return board; }

LightField lightOf(const std::vector<GrayImage>& images) {
  std::vector<Background> backgrounds;
  for (const GrayImage& image : images) backgrounds.emplace_back(image);
  std::vector<const Background*> pictures;
  for (const Background& background : backgrounds) pictures.push_back(&background);
  return {pictures, images.front().width, images.front().height};
}

void expectLamp(const LightField& light, double within) {
  EXPECT_DOUBLE_EQ(light.at(kMiddle), 1.0);
  for (const double x : {40.0, 640.0, 1240.0}) {
    for (const double y : {40.0, 480.0, 920.0}) {
      const Vector2d pixel(x, y);
      EXPECT_NEAR(light.at(pixel), lamp(pixel) / lamp(kMiddle), within) << x << " " << y;
    }
  }
}

void expectEven(const LightField& light) {
  for (const Vector2d& pixel : {Vector2d(0.0, 0.0), kMiddle, Vector2d(1279.0, 20.0)})
    EXPECT_DOUBLE_EQ(light.at(pixel), 1.0);
}

TEST(LightField, IsThatOfLampAndLens) { expectLamp(lightOf({picture(150.0, plain)}), 0.012); }

TEST(LightField, PrintAndWideCutsAreNoPartOfIt) {
  const auto covered = [](int x, int y, double board) {
    if (x < 420 && y < 700) return 0.3 * board;        // Ink over a fourth of the picture.
    if (x > 800 && x < 1000 && y > 500) return 240.0;  // A hole that fills cells.
    return board;
  };
  expectLamp(lightOf({picture(110.0, covered)}), 0.03);
}

TEST(LightField, WhatLiesInOnePictureIsOpenInTheNext) {
  // Each is covered by more than half, but the camera carries its light with it.
  const auto left = [](int x, int, double board) { return x < 700 ? 0.3 * board : board; };
  const auto right = [](int x, int, double board) { return x > 580 ? 0.3 * board : board; };
  expectLamp(lightOf({picture(150.0, left), picture(150.0, right), picture(150.0, plain)}), 0.02);
}

TEST(LightField, IsEvenWhereNothingTellsIt) {
  const auto patchwork = [](int x, int y, double) {
    const CounterRandom random(3, 2);
    return 20.0 + 200.0 * random.uniform(static_cast<std::uint64_t>(x / 64 + 100 * (y / 64)));
  };
  expectEven(lightOf({picture(0.0, patchwork)}));
  expectEven(lightOf({picture(3.0, plain)}));              // Too dark.
  expectEven(lightOf({picture(150.0, plain, 256, 320)}));  // Too few cells.
}

TEST(LightField, IsNeverNothing) {
  const LightField light = lightOf({picture(150.0, plain)});
  EXPECT_DOUBLE_EQ(light.at(kMiddle + Vector2d(4000.0, 4000.0)), 0.05);
}

TEST(KerfLight, IsTheSameWithPanelsPrintedOnTheBoard) {
  // Two panels, one of them of dark ink, over a third of the picture.
  const auto panels = [](int x, int y, double board) {
    if (x > 900 && y < 500) return 0.2 * board;
    if (x < 500 && y > 600) return 0.6 * board;
    return board;
  };
  const LightField printed = lightOf({picture(150.0, panels)});
  const LightField open = lightOf({picture(150.0, plain)});
  for (const double x : {40.0, 640.0, 1240.0}) {
    for (const double y : {40.0, 480.0, 920.0})
      EXPECT_NEAR(printed.at({x, y}), open.at({x, y}), 0.03) << x << " " << y;
  }
}

}  // namespace
}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
// Imperfections of the kerf camera.
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/twin/camera/cameras.h"
#include "tests/twin/camera/statistics.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Isometry2d;
using Eigen::Vector2d;

const double kBoard = kOpenKerfGray * thinBoard().transmission;

PrintLayout blank(int units = 1) {
  PrintLayout print;
  print.units = units;
  print.pitch_mm = 80.0;
  return print;
}

/// A camera straight above, 0.04 mm to the pixel: 1 mm is 25 px; x along the table's x, y against it.
CameraDescription straight() {
  CameraDescription camera = withoutNoise(cameraAbove(1000, 500, 0.04, 0.0));
  camera.fy_px = camera.fx_px;
  camera.distortion = {};
  camera.bits = 12;
  return camera;
}

GrayImage render(const CameraDescription& description, const Sheet& sheet, const Vector2d& p_TV_mm = {0, 0},
                 std::uint64_t seed = 1, const PrintLayout& print = blank(), int unit = 0) {
  return KerfCamera(description, print, seed).render(sheet, unit, p_TV_mm, Isometry2d::Identity());
}

Sheet sheetWithLine() {
  Sheet sheet{thinBoard()};
  const double energy_j = 0.75 * 0.105 * std::sqrt(std::numbers::pi / 2.0) * 60.0;
  sheet.burn({{-30.0, 0.013}, 0.105, 0.105}, {{30.0, 0.013}, 0.105, 0.105}, energy_j);
  return sheet;
}

/// A camera with 0.01 mm to the pixel: an edge can be read between the pixels.
CameraDescription closeUp() {
  CameraDescription camera = withoutNoise(cameraAbove(1000, 160, 0.01, 0.0));
  camera.fy_px = camera.fx_px;
  camera.distortion = {};
  camera.bits = 12;
  return camera;
}

/// Distances of rough edges of the line from smooth ones, column by column, mm.
struct Edges {
  std::vector<double> upper, lower;
};
Edges edgesOf(const GrayImage& image) {
  const double half = 0.5 * (kBoard + kOpenKerfGray);
  Edges edges;
  for (int x = 0; x < image.width; ++x) {
    for (int y = 1; y < image.height; ++y) {
      const double before = image.gray(x, y - 1), here = image.gray(x, y);
      const double place_mm = 0.01 * (y - 1 + (half - before) / (here - before));
      if (before < half && here >= half) edges.upper.push_back(place_mm);
      if (before >= half && here < half) edges.lower.push_back(place_mm);
    }
  }
  return edges;
}
/// Edges of several boards, one after another.
Edges roughnessOf(const EdgeRoughness& roughness) {
  const Sheet sheet = sheetWithLine();
  CameraDescription description = closeUp();
  const Edges smooth = edgesOf(render(description, sheet));
  description.roughness = roughness;
  Edges off;
  for (description.board_seed = 1; description.board_seed <= 12; ++description.board_seed) {
    const Edges rough = edgesOf(render(description, sheet));
    for (std::size_t i = 0; i < smooth.upper.size(); ++i) {
      off.upper.push_back(rough.upper.at(i) - smooth.upper[i]);
      off.lower.push_back(rough.lower.at(i) - smooth.lower[i]);
    }
  }
  return off;
}

double meanOf(const std::vector<double>& a) {
  double sum = 0.0;
  for (const double value : a) sum += value;
  return sum / static_cast<double>(a.size());
}
/// Correlation of two edges, the second one `shift` columns further on.
double likenessOf(const std::vector<double>& a, const std::vector<double>& b, std::size_t shift = 0) {
  double product = 0.0, square_a = 0.0, square_b = 0.0;
  for (std::size_t i = 0; i + shift < a.size(); ++i) {
    product += a[i] * b[i + shift];
    square_a += a[i] * a[i];
    square_b += b[i + shift] * b[i + shift];
  }
  return product / std::sqrt(square_a * square_b);
}
double rmsOf(const std::vector<double>& a) {
  double square = 0.0;
  for (const double value : a) square += value * value;
  return std::sqrt(square / static_cast<double>(a.size()));
}

TEST(HardKerfCamera, EdgesAreAsRoughAsTheDescriptionSays) {
  const Edges off = roughnessOf({.rms_mm = 0.008, .length_mm = 0.06});
  for (const std::vector<double>* edge : {&off.upper, &off.lower}) {
    // The line has some 1100 independent pieces of edge.
    EXPECT_NEAR(rmsOf(*edge), 0.008, 0.0008);
    EXPECT_NEAR(meanOf(*edge), 0.0, 0.001);
    EXPECT_NEAR(likenessOf(*edge, *edge, 6), 1.0 / std::numbers::e, 0.1);
    EXPECT_NEAR(likenessOf(*edge, *edge, 30), 0.0, 0.1);
  }
}

TEST(HardKerfCamera, ShortRoughnessIsOfEachEdgeForItselfLongRoughnessOfBoth) {
  // The kerf is 0.1 mm wide.
  const Edges rough = roughnessOf({.rms_mm = 0.005, .length_mm = 0.04});
  EXPECT_NEAR(likenessOf(rough.upper, rough.lower), 0.0, 0.1);
  const Edges wavy = roughnessOf({.rms_mm = 0.005, .length_mm = 1.0});
  EXPECT_GT(likenessOf(wavy.upper, wavy.lower), 0.95);
}

TEST(HardKerfCamera, GrainAndRoughnessAreFixedToTheBoard) {
  const Sheet sheet = sheetWithLine();
  CameraDescription description = straight();
  description.roughness = {.rms_mm = 0.01, .length_mm = 0.08};
  description.texture = {.grain_gray = 4.0, .grain_length_mm = 0.06};
  const GrayImage first = render(description, sheet);
  // The camera moves by 2 mm along x and 1 mm along y: 50 px to the left, 25 px down.
  const GrayImage second = render(description, sheet, {2.0, 1.0}, 99);
  double largest = 0.0;
  for (int y = 60; y < 440; ++y) {
    for (int x = 60; x < 940; ++x)
      largest = std::max(largest, std::abs(first.gray(x, y) - second.gray(x - 50, y + 25)));
  }
  EXPECT_LT(largest, 1.5);
  EXPECT_GT(momentsOf(first, {100, 20, 800, 150}).rms, 3.8);
  description.board_seed = 2;
  EXPECT_NEAR(correlationOf(first, render(description, sheet), {100, 20, 800, 150}, 0, 0), 0.0, 0.03);
  // A different unit shows a different piece of board.
  description.board_seed = 1;
  EXPECT_NEAR(
      correlationOf(first, render(description, sheet, {0, 0}, 1, blank(2), 1), {100, 20, 800, 150}, 0, 0),
      0.0, 0.03);
}

TEST(HardKerfCamera, GrainIsOfTheBoardNotOfTheOpenKerf) {
  CameraDescription description = straight();
  description.texture = {.grain_gray = 4.0, .grain_length_mm = 0.06};
  Sheet sheet{thinBoard()};
  for (double y = -2.0; y <= 2.0; y += 0.05)
    sheet.burn({{-2.0, y}, 0.105, 0.105}, {{2.0, y}, 0.105, 0.105}, 4.0 * 0.05 * 0.75);
  PrintLayout print = blank();
  print.marks = {{{8.0, 0.0}, 4.0}};
  const GrayImage image = render(description, sheet, {0, 0}, 1, print);
  const PlaneProjection projection(description);
  const auto around = [&](double x_mm, double y_mm) {
    const Vector2d pixel = *projection.pixelOf({x_mm, y_mm});
    return momentsOf(image, {static_cast<int>(pixel.x()) - 20, static_cast<int>(pixel.y()) - 20, 41, 41});
  };
  const Moments plain = momentsOf(image, {20, 20, 960, 150});
  EXPECT_NEAR(plain.mean, kBoard, 0.1);
  EXPECT_NEAR(plain.rms, 4.0, 0.1);
  EXPECT_NEAR(around(0.0, 0.0).mean, kOpenKerfGray, 0.1);
  EXPECT_LT(around(0.0, 0.0).rms, 0.1);
  EXPECT_NEAR(around(8.0, 0.0).rms, 4.0 * 0.02 / 0.12, 0.1);
}

TEST(HardKerfCamera, OtherPrintLetsLessLightThrough) {
  const CameraDescription description = withoutNoise(cameraAbove(1024, 768, 0.04));
  PrintLayout print = blank(2);
  print.areas = {{.p_SA_mm = {3.0, 4.0}, .size_mm = {3.0, 0.8}, .angle_rad = -0.4},
                 {.p_SA_mm = {-9.0, -5.0}, .size_mm = {2.0, 2.5}, .ink = 0.5}};
  const PlaneProjection projection(description);
  const Sheet sheet{thinBoard()};
  for (const int unit : {0, 1}) {
    const GrayImage image = render(description, sheet, {0.7, -0.3}, 1, print, unit);
    for (const PrintedArea& area : print.areas) {
      const Vector2d p_V_mm = area.p_SA_mm - Vector2d(0.7, -0.3);
      const Vector2d truth = *projection.pixelOf(p_V_mm);
      const Centroid found = centroidAround(image, truth, 60, std::round(kBoard));
      EXPECT_LT((found.pixel - truth).norm(), 0.05);
      const double area_px = area.size_mm.prod() * std::abs(projection.jacobianAt(p_V_mm).determinant());
      const double darker = area.ink * kOpenKerfGray * 0.1;
      EXPECT_NEAR(found.sum / darker, area_px, 0.03 * area_px);
    }
  }
}

TEST(HardKerfCamera, AHardTileIsTheSameFromAnyCopyAndHasItsDepth) {
  CameraDescription description = cameraAbove(500, 400, 0.04);
  description.bits = 10;
  description.texture.grain_gray = 3.0;
  description.roughness.rms_mm = 0.01;
  description.light = {.vignette = 0.3, .gradient_x = 0.2};
  description.hot.share = 1e-4;
  const Sheet sheet = sheetWithLine();
  const GrayImage first = render(description, sheet);
  EXPECT_EQ(first.bits, 10);
  EXPECT_EQ(render(description, sheet).levels, first.levels);
  EXPECT_NE(render(description, sheet, {0, 0}, 2).levels, first.levels);
  EXPECT_LT(momentsOf(first, {0, 0, 40, 40}).mean, 0.75 * momentsOf(first, {230, 140, 40, 40}).mean);
}

}  // namespace
}  // namespace kerfbench::twin

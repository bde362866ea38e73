// SPDX-License-Identifier: Apache-2.0
// Pictures of the cut that must not be measured are reported as such, and good ones are not.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_faults.h"
#include "tests/hil/vision/kerf_twin.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using test::TwinCut;

TwinCut aCut() {
  TwinCut cut;
  cut.add(dieline::LineCurve{{-10.0, 0.0}, {10.0, 0.0}});
  return cut;
}

KerfScan scanOf(const std::function<void(TwinCut&)>& change) {
  TwinCut cut = aCut();
  change(cut);
  return cut.scan();
}

/// Scan with every pixel of the pictures replaced.
KerfScan scanWith(const std::function<std::uint8_t(std::uint8_t)>& level) {
  const TwinCut cut = aCut();
  auto tiles = cut.tiles();
  for (auto& pixel : tiles[0].image.pixels) pixel = level(pixel);
  return cut.scan(std::move(tiles));
}

bool tells(const KerfScan& scan, const std::string& word) {
  return std::any_of(scan.problems.begin(), scan.problems.end(),
                     [&](const std::string& problem) { return problem.find(word) != std::string::npos; });
}

TEST(KerfRefusal, GoodPicturesAreNotRefused) {
  const KerfScan plain = scanOf([](TwinCut&) {});
  EXPECT_TRUE(plain.problems.empty()) << plain.problems.front();
  const KerfScan hard = scanOf([](TwinCut& c) {
    c.camera.bits = 12;
    c.camera.read_noise = 2.5;
    c.camera.psf_sigma_px = 1.0;
    c.camera.texture = {.grain_gray = 3.0, .grain_length_mm = 0.1};
    c.camera.light = {.vignette = 0.3, .gradient_x = 0.2};
  });
  EXPECT_TRUE(hard.problems.empty()) << hard.problems.front();
}

TEST(KerfRefusal, DarkPictures) {
  EXPECT_TRUE(
      tells(scanOf([](TwinCut& c) { c.board.transmission = c.board.print_transmission = 0.005; }), "dark"));
  EXPECT_TRUE(tells(scanWith([](std::uint8_t level) -> std::uint8_t { return level / 16; }), "dark"));
}

TEST(KerfRefusal, SaturatedPictures) {
  EXPECT_TRUE(tells(scanWith([](std::uint8_t level) -> std::uint8_t { return level > 20 ? 255 : level; }),
                    "saturated"));
}

TEST(KerfRefusal, EmptyPictures) {
  const KerfScan scan = scanWith([](std::uint8_t) -> std::uint8_t { return 30; });
  EXPECT_TRUE(tells(scan, "without any noise"));
  EXPECT_TRUE(tells(scan, "no registration mark"));
  EXPECT_TRUE(tells(scanWith([](std::uint8_t) -> std::uint8_t { return 0; }), "dark"));
}

TEST(KerfRefusal, NoPictureAtAll) { EXPECT_TRUE(tells(aCut().scan({}), "no tile")); }

TEST(KerfRefusal, BlurredPictures) {
  for (const double psf_px : {1.8, 2.0}) {
    const KerfScan scan = scanOf([&](TwinCut& c) { c.camera.psf_sigma_px = psf_px; });
    ASSERT_FALSE(scan.problems.empty()) << psf_px;
    std::printf("  psf %.1f px: %s\n", psf_px, scan.problems.front().c_str());
  }
  EXPECT_TRUE(tells(scanOf([](TwinCut& c) { c.camera.psf_sigma_px = 1.8; }), "blurred"));
}

TEST(KerfRefusal, OfManyPicturesTheFirstEightAreNamed) {
  for (const std::size_t count : {1U, 8U, 9U, 30U}) {
    std::vector<TileView> views(count);
    for (TileView& view : views) view.background.emplace(GrayImage(128, 128, 2));
    std::vector<std::string> problems;
    tellTileFaults(views, 0, kUsualBlur, 1.5, problems);
    ASSERT_FALSE(problems.empty());
    const std::string& dark = problems.front();
    const auto named = static_cast<std::size_t>(std::count(dark.begin(), dark.end(), ',')) + 1;
    EXPECT_EQ(named, std::min<std::size_t>(count, 8)) << dark;
    EXPECT_EQ(dark.ends_with("…"), count > 8) << dark;
  }
}

TEST(KerfRefusal, WhatIsTooDarkOrTooBrightHasItsLimit) {
  const auto told = [](std::uint8_t board, double saturated_share) {
    GrayImage image(1024, 1024, board);
    const CounterRandom random(3, 0);
    std::uint64_t next = 0;
    for (std::uint8_t& pixel : image.pixels) pixel = random.uniform(next++) < saturated_share ? 255 : pixel;
    std::vector<TileView> views(1);
    views[0].background.emplace(image);
    std::vector<std::string> problems;
    tellTileFaults(views, 0, kUsualBlur, 1.5, problems);
    return problems;
  };
  using ::testing::Contains;
  using ::testing::HasSubstr;
  using ::testing::Not;
  EXPECT_THAT(told(3, 0.0), Contains(HasSubstr("dark")));
  EXPECT_THAT(told(4, 0.0), Not(Contains(HasSubstr("dark"))));
  EXPECT_THAT(told(30, 0.022), Contains(HasSubstr("saturated")));
  EXPECT_THAT(told(30, 0.018), Not(Contains(HasSubstr("saturated"))));
}

TEST(KerfRefusal, TheBlurOfAnEdgeIsThatOfTheCamera) {
  for (const double psf_px : {0.5, 0.7, 1.0, 1.5}) {
    TwinCut cut = aCut();
    cut.camera.psf_sigma_px = psf_px;
    const CameraCalibration calibration = test::calibrationOf(cut.camera);
    const TileView view = viewTile(cut.tiles()[0], calibration, {3.0});
    ASSERT_EQ(view.marks.size(), 4U) << psf_px;
    double mean_px = 0.0;
    for (const FoundMark& mark : view.marks)
      mean_px += 0.25 * edgeBlurPx(view.tile.image, calibration, mark, view.noise_gray);
    std::printf("  psf %.2f px, seen %.3f px\n", psf_px, mean_px);
    EXPECT_NEAR(mean_px, psf_px, 0.02);
  }
}

TEST(KerfRefusal, PicturesOfAnotherSize) {
  const TwinCut cut = aCut();
  auto tiles = cut.tiles();
  tiles[0].image = GrayImage(1099, 800, 30);
  EXPECT_THROW((void)cut.scan(std::move(tiles)), std::invalid_argument);
}

TEST(KerfRefusal, MarksThatAreMissingOrMoved) {
  TwinCut cut = aCut();
  const auto full = cut.print;
  cut.print.marks.resize(1);
  auto tiles = cut.tiles();
  cut.print = full;
  EXPECT_FALSE(cut.scan(std::move(tiles)).problems.empty());

  cut.print.marks[0].p_SM_mm.x() += 0.4;
  cut.print.marks[1].p_SM_mm.y() -= 0.4;
  cut.print.marks[2].p_SM_mm.x() -= 0.4;
  tiles = cut.tiles();
  cut.print = full;
  EXPECT_FALSE(cut.scan(std::move(tiles)).problems.empty());
}

TEST(KerfRefusal, OneMarkThatLiesElsewhereIsNamed) {
  // On the sheet 0.06 mm: less than the pose leaves out. 0.3 mm: left out. 0.8 mm: no mark of the print.
  for (const double off_mm : {0.06, 0.3, 0.8}) {
    TwinCut cut = aCut();
    cut.options.print_sigma_mm = 0.002;
    const PrintLayout told = cut.print;
    ASSERT_EQ(told.marks.size(), 4U);
    cut.print.marks[2].p_SM_mm.x() += off_mm;
    auto tiles = cut.tiles();
    cut.print = told;
    const KerfScan scan = cut.scan(std::move(tiles));
    EXPECT_TRUE(tells(scan, "registration mark 3")) << off_mm;
    EXPECT_TRUE(tells(scan, fmt::format("lies {:.2f}", off_mm))) << scan.problems.front();
  }
}

TEST(KerfRefusal, OfThreeMarksNobodyKnowsWhichLiesElsewhere) {
  TwinCut cut = aCut();
  cut.print.marks.resize(3);
  const PrintLayout told = cut.print;
  cut.print.marks[1].p_SM_mm.x() += 0.06;
  auto tiles = cut.tiles();
  cut.print = told;
  EXPECT_TRUE(tells(cut.scan(std::move(tiles)), "its 3 registration marks lie to each other"));
}

TEST(KerfRefusal, ABoardBesideTheField) {
  TwinCut cut = aCut();
  auto tiles = cut.tiles();
  tiles[0].p_TV_mm.x() += 40.0;  // The table's scale reads another place of the camera.
  EXPECT_FALSE(cut.scan(std::move(tiles)).problems.empty());
}

}  // namespace
}  // namespace kerfbench::vision

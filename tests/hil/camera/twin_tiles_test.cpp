// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/twin/twin_tiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "tests/hil/camera/small_cameras.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

PrintLayout twoUnits() {
  PrintLayout print;
  print.units = 2;
  print.pitch_mm = 60.0;
  print.marks = {{{-3.0, -3.0}, 3.0}, {{43.0, 28.0}, 3.0}};
  return print;
}

twin::KerfCamera camera(const PrintLayout& print) { return {smallCamera(400, 300, 0.05), print, 4}; }

/// Field of 20 x 15 mm, unit of 40 x 25 mm.
const std::vector<AlignedBox2d> kDieline{
    AlignedBox2d(Vector2d(0, 0), Vector2d(40, 0)), AlignedBox2d(Vector2d(0, 0), Vector2d(0, 25)),
    AlignedBox2d(Vector2d(0, 25), Vector2d(40, 25)), AlignedBox2d(Vector2d(40, 0), Vector2d(40, 25))};

std::vector<KerfTile> readAll(TwinTileSource& from, std::size_t batch) {
  std::vector<KerfTile> all;
  for (auto tiles = from.nextBatch(batch); !tiles.empty(); tiles = from.nextBatch(batch)) {
    EXPECT_LE(tiles.size(), batch);
    for (KerfTile& tile : tiles) all.push_back(std::move(tile));
  }
  return all;
}

/// Number of tiles of a unit that see a point of its S with `margin_mm` to spare.
int seenBy(const std::vector<KerfTile>& tiles, const TwinTileSource& source, const AlignedBox2d& field,
           int unit, const Vector2d& p_S_mm, double margin_mm) {
  int count = 0;
  for (const KerfTile& tile : tiles) {
    const Vector2d p_V_mm = source.lay(unit) * p_S_mm - tile.p_TV_mm;
    if (tile.unit == unit && field.exteriorDistance(p_V_mm) == 0.0 &&
        (p_V_mm - field.min()).minCoeff() >= margin_mm && (field.max() - p_V_mm).minCoeff() >= margin_mm) {
      ++count;
    }
  }
  return count;
}

TEST(TwinTileSource, TakesTilesWhereTheTableIsAndTellsWhereItSays) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  const twin::KerfCamera eye = camera(twoUnits());
  TwinTileOptions options;
  options.table = {.step_mm = 0.0, .scale = 0.001};
  TwinTileSource stretched(eye, sheet, kDieline, options);
  TwinTileSource plain(eye, sheet, kDieline, {});
  const std::vector<KerfTile> tiles = readAll(stretched, 4);
  const std::vector<KerfTile> exact = readAll(plain, 4);
  ASSERT_EQ(tiles.size(), exact.size());
  for (std::size_t i = 0; i < tiles.size(); ++i) EXPECT_EQ(tiles[i].p_TV_mm, exact[i].p_TV_mm);
  // Stops that are off are others for each tile, and the same again.
  options.table = {.step_mm = 0.01, .scale = 0.0};
  TwinTileSource one(eye, sheet, kDieline, options);
  TwinTileSource again(eye, sheet, kDieline, options);
  const std::vector<KerfTile> first = readAll(one, 4);
  const std::vector<KerfTile> second = readAll(again, 7);
  int moved = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].image.pixels, second[i].image.pixels);
    moved += first[i].image.pixels == exact[i].image.pixels ? 0 : 1;
  }
  EXPECT_EQ(moved, static_cast<int>(first.size()));
  // The last tile is as one taken at the place that a scale of 1.001 means.
  const KerfTile& last = tiles.back();
  const GrayImage there =
      eye.render(sheet, last.unit, 1.001 * last.p_TV_mm, stretched.lay(last.unit), {.max_x_S_mm = 50.0});
  EXPECT_EQ(last.image.pixels, there.pixels);
}

TEST(TwinTileSource, ATableThatBowsMovesTilesAside) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  const twin::KerfCamera eye = camera(twoUnits());
  TwinTileOptions options;
  options.table = {.bow_x = {0.01, 0.3}, .bow_y = {0.02, 1.1}};
  TwinTileSource bowed(eye, sheet, kDieline, options);
  TwinTileSource again(eye, sheet, kDieline, options);
  const std::vector<KerfTile> tiles = readAll(bowed, 4);
  std::map<double, double> aside_by_y;
  double least = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const Vector2d off_mm = bowed.takenAt(i) - tiles[i].p_TV_mm;
    EXPECT_EQ(bowed.takenAt(i), again.takenAt(i));
    constexpr double kTurn_mm = 2.0 * std::numbers::pi / 150.0;
    EXPECT_NEAR(off_mm.x(), 0.01 * std::sin(kTurn_mm * tiles[i].p_TV_mm.y() + 0.3), 1e-12);
    EXPECT_NEAR(off_mm.y(), 0.02 * std::sin(kTurn_mm * tiles[i].p_TV_mm.x() + 1.1), 1e-12);
    // All tiles of a row go aside alike.
    const auto [same, is_new] = aside_by_y.emplace(tiles[i].p_TV_mm.y(), off_mm.x());
    if (!is_new) {
      EXPECT_NEAR(same->second, off_mm.x(), 1e-12);
    }
    least = std::min(least, off_mm.x());
    most = std::max(most, off_mm.x());
  }
  ASSERT_GE(aside_by_y.size(), 2U);
  EXPECT_GT(most - least, 0.002);
  const KerfTile& last = tiles.back();
  EXPECT_EQ(last.image.pixels, eye.render(sheet, last.unit, bowed.takenAt(tiles.size() - 1),
                                          bowed.lay(last.unit), {.max_x_S_mm = 50.0})
                                   .pixels);
}

TEST(TwinTileSource, CoversEveryUnitWithItsMarks) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  TwinTileSource source(camera(twoUnits()), sheet, kDieline, {});
  const AlignedBox2d field = camera(twoUnits()).field();
  const std::size_t promised = source.size();
  const std::vector<KerfTile> tiles = readAll(source, 5);
  EXPECT_EQ(tiles.size(), promised);
  for (int unit = 0; unit < 2; ++unit) {
    for (double x = -4.5; x <= 44.5; x += 0.7) {
      for (double y = -4.5; y <= 29.5; y += 0.7) {
        // A caliper of 0.6 mm anywhere lies wholly within at least one tile.
        EXPECT_GE(seenBy(tiles, source, field, unit, {x, y}, 0.6), 1) << unit << " " << x << " " << y;
      }
    }
  }
}

TEST(TwinTileSource, LaysEachUnitDownDifferentlyWithinTheLimits) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  const TwinTileSource source(camera(twoUnits()), sheet, kDieline, {});
  EXPECT_FALSE(source.lay(0).isApprox(source.lay(1)));
  for (int unit = 0; unit < 2; ++unit) {
    const Vector2d middle(20.0, 12.5);
    EXPECT_LE((source.lay(unit) * middle - middle).cwiseAbs().maxCoeff(), 1.0);
    EXPECT_LE(std::abs(Eigen::Rotation2Dd(source.lay(unit).linear()).angle()),
              0.3 * std::numbers::pi / 180.0);
    EXPECT_FALSE(source.lay(unit).isApprox(Eigen::Isometry2d::Identity()));
  }
}

TEST(TwinTileSource, GivesTheSameTilesAtAnyNumberOfThreads) {
  twin::Sheet sheet{twin::BoardDescription{}};
  sheet.burn({{0.0, 0.0}, 0.1, 0.1}, {{40.0, 25.0}, 0.1, 0.1}, 5.0);
  TwinTileSource one(camera(twoUnits()), sheet, kDieline, {.threads = 1});
  TwinTileSource two(camera(twoUnits()), sheet, kDieline, {.threads = 2});
  const std::vector<KerfTile> a = readAll(one, 3);
  const std::vector<KerfTile> b = readAll(two, 100);
  ASSERT_EQ(a.size(), b.size());
  bool burnt = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].unit, b[i].unit);
    EXPECT_EQ(a[i].p_TV_mm, b[i].p_TV_mm);
    EXPECT_EQ(a[i].image.pixels, b[i].image.pixels);
    for (const std::uint8_t gray : a[i].image.pixels) burnt = burnt || gray > 200;
  }
  EXPECT_TRUE(burnt);
}

TEST(TwinTileSource, APartedWebGivesTheTilesOfTheWholeSheet) {
  twin::BoardDescription board;
  board.scorch = {.fluence_j_mm2 = 0.2, .darkening = 0.3, .shift_mm = {0.9, 0.0}};
  twin::Sheet sheet{board};
  // Over both units and the parting between them.
  sheet.burn({{-50.0, 3.0}, 0.1, 0.1}, {{40.0, 25.0}, 0.1, 0.1}, 10.0);
  TwinTileSource whole(camera(twoUnits()), sheet, kDieline, {});
  const std::vector<KerfTile> wanted = readAll(whole, 100);
  const auto feed = std::make_shared<SheetFeed>(1);
  TwinTileSource parted(camera(twoUnits()), feed, kDieline, {});
  const auto partings = parted.partings_S_mm();
  ASSERT_TRUE(partings && partings->size() == 1);
  feed->add(std::make_shared<const twin::Sheet>(sheet.part(partings->front())));
  feed->end(std::make_shared<const twin::Sheet>(sheet));
  const std::vector<KerfTile> seen = readAll(parted, 3);
  ASSERT_EQ(seen.size(), wanted.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].image.pixels, wanted[i].image.pixels);
    EXPECT_EQ(seen[i].p_TV_mm, wanted[i].p_TV_mm);
    EXPECT_EQ(seen[i].is_last, i + 1 == seen.size() || seen[i + 1].unit != seen[i].unit);
  }
}

TEST(TwinTileSource, AWebIsNotPartedWhereUnitsReachIntoEachOther) {
  PrintLayout print = twoUnits();
  print.pitch_mm = 45.0;
  EXPECT_FALSE(TwinTileSource(camera(print), std::make_shared<SheetFeed>(1), kDieline, {})
                   .partings_S_mm()
                   .has_value());
}

TEST(TwinTileSource, LooksAtTheBoxesOfInterestOnlyWhenAsked) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  PrintLayout print = twoUnits();
  print.units = 1;
  print.pitch_mm = 500.0;
  const std::vector<AlignedBox2d> far{AlignedBox2d(Vector2d(0, 0), Vector2d(5, 5)),
                                      AlignedBox2d(Vector2d(150, 100), Vector2d(155, 105))};
  TwinTileSource everything(camera(print), sheet, far, {});
  TwinTileSource few(camera(print), sheet, far, {.everything = false});
  EXPECT_LT(2 * few.size(), everything.size());
  const std::vector<KerfTile> tiles = readAll(few, 10);
  for (const Vector2d& p :
       {Vector2d(0, 0), Vector2d(5, 5), Vector2d(150, 105), Vector2d(-3, -3), Vector2d(43, 28)}) {
    EXPECT_GE(seenBy(tiles, few, camera(print).field(), 0, p, 0.6), 1) << p.transpose();
  }
}

TEST(TwinTileSource, ALongStripIsOneRowOfTiles) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  PrintLayout print;
  print.pitch_mm = 1000.0;
  const TwinTileSource source(camera(print), sheet, {AlignedBox2d(Vector2d(-800, 0), Vector2d(0, 0))}, {});
  // The unit is 804 mm long, in steps of a little less than 17 mm.
  EXPECT_GE(source.size(), 47U);
  EXPECT_LE(source.size(), 50U);
}

TEST(TwinTileSource, DoesNotShowWhatBelongsToTheNeighbour) {
  twin::Sheet sheet{twin::BoardDescription{}};
  // The burn lies at x = 51 … 55 in S of unit 1: nearer to unit 0, which it is part of.
  sheet.burn({{-9.0, 5.0}, 0.1, 0.1}, {{-5.0, 5.0}, 0.1, 0.1}, 2.0);
  PrintLayout print = twoUnits();
  print.pitch_mm = 60.0;
  TwinTileSource source(camera(print), sheet, kDieline, {.border_mm = 12.0});
  int bright_of_unit[2] = {0, 0};
  for (const KerfTile& tile : readAll(source, 10)) {
    for (const std::uint8_t gray : tile.image.pixels) bright_of_unit[tile.unit] += gray > 200 ? 1 : 0;
  }
  EXPECT_GT(bright_of_unit[0], 100);
  EXPECT_EQ(bright_of_unit[1], 0);
}

TEST(TwinTileSource, RefusesToLookAtNothing) {
  const twin::Sheet sheet{twin::BoardDescription{}};
  PrintLayout print;
  print.pitch_mm = 10.0;
  EXPECT_THROW(TwinTileSource(camera(print), sheet, {}, {}), std::invalid_argument);
  EXPECT_THROW(TwinTileSource(camera(print), sheet, {AlignedBox2d()}, {}), std::invalid_argument);
  EXPECT_THROW(TwinTileSource(camera(twoUnits()), sheet, kDieline, {.overlap_mm = 30.0}),
               std::invalid_argument);
  EXPECT_THROW(TwinTileSource(camera(twoUnits()), sheet, kDieline, {.border_mm = -1.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::camera

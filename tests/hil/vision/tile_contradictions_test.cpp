// SPDX-License-Identifier: Apache-2.0
// Pictures of one sheet may show the end of a cut a little apart, and nothing else.
#include "hil/vision/scan/tile_contradictions.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "tests/hil/vision/kerf_workpiece.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using test::Truth;
using test::Workpiece;

/// Lines that two pictures show, each with a piece missing; where it begins and ends lies a little farther on
/// from line to line, less than from station to station.
Workpiece linesWithGaps() {
  constexpr int kLines = 6;
  Workpiece work;
  work.dieline.entities.clear();
  for (int k = 0; k < kLines; ++k) {
    const double x = 17.9 + k;
    dieline::Entity& entity = work.dieline.entities.emplace_back();
    entity.id = k;
    entity.curve = test::line({x, 4.0}, {x, 9.0});
    const double on_mm = work.options.station_pitch_mm / kLines * k;
    work.truth[k] = Truth{.gap_begin_mm = 2.0 + on_mm, .gap_end_mm = 3.1 + on_mm};
  }
  return work;
}

const auto kContradict = ::testing::Contains(::testing::HasSubstr("pictures contradict each other"));

TEST(TileContradictions, WhereACutEndsATableMayHaveStoppedALittleApart) {
  const Workpiece work = linesWithGaps();
  const std::vector<camera::KerfTile> good = work.tiles();
  for (const double along_mm : {-0.03, 0.03}) {
    std::vector<camera::KerfTile> tiles = good;
    tiles[1].p_TV_mm.y() += along_mm;
    EXPECT_THAT(work.scan(tiles).problems, ::testing::Not(kContradict)) << along_mm << " mm";
  }
}

/// Pictures of which one, of the two that show the line in the middle, has a patch of this gray on it, as
/// long as the pitch of stations, about the one at y_mm.
std::vector<camera::KerfTile> withPatch(const Workpiece& work, std::vector<camera::KerfTile> tiles,
                                        double y_mm, double gray, std::size_t which = 0) {
  const int half = static_cast<int>(0.5 * work.options.station_pitch_mm / test::kPitchMm);
  const Eigen::Vector2d p_V = work.tableFromSheet({20.9, y_mm}) - tiles[which].p_TV_mm;
  const Eigen::Vector2d at = work.camera.pixelIfSeen(p_V, 0.0).value();
  for (int row = -half; row <= half; ++row) {
    for (int column = -half; column <= half; ++column) {
      tiles[which].image.at(static_cast<int>(at.x()) + column, static_cast<int>(at.y()) + row) =
          static_cast<std::uint8_t>(gray);
    }
  }
  return tiles;
}

TEST(TileContradictions, OneStationThatOnlyOnePictureShowsContradicts) {
  const Workpiece work = linesWithGaps();
  const std::vector<camera::KerfTile> good = work.tiles();
  EXPECT_THAT(work.scan(good).problems, ::testing::Not(kContradict));
  EXPECT_THAT(work.scan(withPatch(work, good, 5.0, test::kBoard)).problems, kContradict) << "not burnt";
  EXPECT_THAT(work.scan(withPatch(work, good, 6.75, test::kOpen)).problems, kContradict) << "burnt";
  // Traces, as board may show anywhere, are weak in both, though the one is hardly half of the other.
  const auto faint = [](double brightness) {
    return test::kBoard + brightness * (test::kOpen - test::kBoard);
  };
  const auto traces = withPatch(work, withPatch(work, good, 6.75, faint(0.075)), 6.75, faint(0.032), 1);
  EXPECT_THAT(work.scan(traces).problems, ::testing::Not(kContradict));
}

TEST(TileContradictions, AtTheSecondStationOfALineAsAnywhere) {
  const Workpiece work = linesWithGaps();
  EXPECT_THAT(
      work.scan(withPatch(work, work.tiles(), 4.0 + work.options.station_pitch_mm, test::kBoard)).problems,
      kContradict);
}

TEST(TileContradictions, AKerfThatIsWiderToOneSideInOnePictureContradicts) {
  const Workpiece work = linesWithGaps();
  for (const double side : {-1.0, 1.0}) {
    std::vector<camera::KerfTile> tiles = work.tiles();
    const Eigen::Vector2d beside_S(20.9 + side * (0.5 * test::kWidthMm + 0.5 * test::kPitchMm), 5.0);
    const Eigen::Vector2d p_V = work.tableFromSheet(beside_S) - tiles[0].p_TV_mm;
    const Eigen::Vector2d at = work.camera.pixelIfSeen(p_V, 0.0).value();
    const int half = static_cast<int>(0.5 * work.options.station_pitch_mm / test::kPitchMm);
    for (int row = -half; row <= half; ++row) {
      tiles[0].image.at(static_cast<int>(std::lround(at.x())), static_cast<int>(at.y()) + row) =
          static_cast<std::uint8_t>(test::kOpen);
    }
    EXPECT_THAT(work.scan(tiles).problems, kContradict) << side;
  }
}

/// Cuts that no one ordered cross the lines at a few degrees: for a millimetre and more two kerfs run
/// together.
Workpiece linesCrossedAslant(double slope) {
  Workpiece work = linesWithGaps();
  work.truth.clear();
  for (const dieline::Entity& entity : work.dieline.entities) {
    const double x = 17.9 + entity.id + 0.03 * entity.id;
    work.extra.push_back(test::line({x - 2.5 * slope, 4.0}, {x + 2.5 * slope, 9.0}));
  }
  return work;
}

TEST(TileContradictions, KerfsThatRunTogetherMayBeReadApartInOnePictureAndAsOneInTheOther) {
  for (const double slope : {0.05, 0.12, -0.2}) {
    const Workpiece work = linesCrossedAslant(slope);
    const std::vector<camera::KerfTile> good = work.tiles();
    for (const double aside_mm : {0.0, 0.002}) {
      std::vector<camera::KerfTile> tiles = good;
      tiles[1].p_TV_mm += Eigen::Vector2d(aside_mm, 2.0 * aside_mm);
      EXPECT_THAT(work.scan(tiles).problems, ::testing::Not(kContradict))
          << slope << ", " << aside_mm << " mm";
    }
  }
}

TEST(TileContradictions, WhatOnePictureShowsAsideOfKerfsThatRunTogetherContradicts) {
  const Workpiece work = linesCrossedAslant(0.05);
  const std::vector<camera::KerfTile> good = work.tiles();
  const GrayImage& whole = good.front().image;
  std::vector<camera::KerfTile> moved = good;
  for (int row = 0; row < whole.height; ++row) {
    for (int column = 0; column + 1 < whole.width; ++column)
      moved.front().image.at(column, row) = whole.at(column + 1, row);
  }
  EXPECT_THAT(work.scan(moved).problems, kContradict) << "a pixel aside";
  EXPECT_THAT(work.scan(withPatch(work, good, 6.5, test::kBoard)).problems, kContradict) << "not burnt";
}

}  // namespace
}  // namespace kerfbench::vision

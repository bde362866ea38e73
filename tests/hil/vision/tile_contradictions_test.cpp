// SPDX-License-Identifier: Apache-2.0
// Pictures of one sheet may show the end of a cut a little apart, and nothing else.
#include "hil/vision/scan/tile_contradictions.h"

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

TEST(TileContradictions, OneStationThatOnlyOnePictureShowsContradicts) {
  const Workpiece work = linesWithGaps();
  const std::vector<camera::KerfTile> good = work.tiles();
  ASSERT_THAT(work.scan(good).problems, ::testing::Not(kContradict));
  // As long as the pitch of stations, about one of them: not burnt in one picture only, or burnt there only.
  const int half = static_cast<int>(0.5 * work.options.station_pitch_mm / test::kPitchMm);
  for (const double y_mm : {5.0, 6.75}) {
    std::vector<camera::KerfTile> tiles = good;
    GrayImage& image = tiles[0].image;
    const Eigen::Vector2d p_V = work.tableFromSheet({20.9, y_mm}) - tiles[0].p_TV_mm;
    const auto at = work.camera.pixelIfSeen(p_V, 0.0);
    ASSERT_TRUE(at);
    const double level = y_mm < 6.0 ? test::kBoard : test::kOpen;
    for (int row = -half; row <= half; ++row) {
      for (int column = -half; column <= half; ++column) {
        image.at(static_cast<int>(at->x()) + column, static_cast<int>(at->y()) + row) =
            static_cast<std::uint8_t>(level);
      }
    }
    EXPECT_THAT(work.scan(tiles).problems, kContradict) << "at " << y_mm << " mm";
  }
}

}  // namespace
}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
// Which cut-outs of the pictures a scan keeps.
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/camera/kerf_tile.h"
#include "hil/dieline/geometry.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::vision {
namespace {

TEST(KerfPatch, IsThatOfTheWorstPlaceOfAllUnits) {
  test::TwinCut good;
  const int line = good.add(dieline::LineCurve{{-5.0, 0.0}, {5.0, 0.0}});
  test::TwinCut bad = good;
  bad.offset_mm[line] = 0.1;
  for (const int worse : {0, 1}) {
    std::vector<camera::KerfTile> tiles = (worse == 0 ? bad : good).tiles();
    std::vector<camera::KerfTile> second = (worse == 1 ? bad : good).tiles();
    second.front().unit = 1;
    tiles.push_back(std::move(second.front()));
    test::TwinCut both = good;
    both.print.units = 2;
    both.options.patches = 1;
    const KerfScan scan = both.scan(std::move(tiles));
    ASSERT_EQ(scan.patches.size(), 1U);
    EXPECT_EQ(scan.patches.front().unit, worse);
  }
}

TEST(KerfMosaicTest, ShowsTheCutsOfTheWorstUnitWhereTheyAre) {
  test::TwinCut good;
  const int line = good.add(dieline::LineCurve{{-5.0, 0.0}, {5.0, 0.0}});
  good.add(dieline::LineCurve{{-5.0, 1.0}, {5.0, 1.0}});
  test::TwinCut bad = good;
  bad.offset_mm[line] = 0.4;
  std::vector<camera::KerfTile> tiles = bad.tiles();
  tiles.front().unit = 1;
  std::vector<camera::KerfTile> both = good.tiles();
  both.push_back(std::move(tiles.front()));
  good.print.units = 2;
  good.options.mosaic_px = 200;
  const KerfMosaic mosaic = good.scan(std::move(both)).mosaic;
  ASSERT_NE(mosaic.image, nullptr);
  EXPECT_EQ(mosaic.unit, 1);
  EXPECT_EQ(mosaic.image->width, 200);
  EXPECT_LT(mosaic.box_S_mm.min().x(), -5.0);
  EXPECT_GT(mosaic.box_S_mm.max().x(), 5.0);
  const auto levelAt = [&](double x_mm, double y_mm) {
    const double pitch_mm = mosaic.box_S_mm.sizes().x() / mosaic.image->width;
    return static_cast<int>(
        mosaic.image->at(static_cast<int>((x_mm - mosaic.box_S_mm.min().x()) / pitch_mm),
                         static_cast<int>((mosaic.box_S_mm.max().y() - y_mm) / pitch_mm)));
  };
  EXPECT_GT(levelAt(1.0, 0.4), 150);  // The cut lies 0.4 mm to the left of its line.
  EXPECT_LT(levelAt(1.0, 0.0), 100);
  EXPECT_GT(levelAt(-3.0, 1.0), 150);  // Rows run down: the upper line is above.
  EXPECT_LT(levelAt(1.0, 0.7), 100);
}

TEST(KerfMosaicTest, IsMadeWhereItIsAskedForAndTheSameAtAnyNumberOfThreads) {
  test::TwinCut cut;
  cut.add(dieline::LineCurve{{-5.0, 0.0}, {5.0, 3.0}});
  EXPECT_EQ(cut.scan(cut.tiles()).mosaic.image, nullptr);
  cut.options.mosaic_px = 120;
  const KerfMosaic one = cut.scan(cut.tiles()).mosaic;
  cut.options.threads = 3;
  const KerfMosaic three = cut.scan(cut.tiles()).mosaic;
  ASSERT_NE(one.image, nullptr);
  EXPECT_EQ(one.image->pixels, three.image->pixels);
}

}  // namespace
}  // namespace kerfbench::vision

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

}  // namespace
}  // namespace kerfbench::vision

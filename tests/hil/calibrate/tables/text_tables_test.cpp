// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <stdexcept>

#include "firmware_under_test/planner/head/correction.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/calibrate/tables/grid_text.h"
#include "hil/calibrate/tables/nine_points.h"
#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using testing::TestWithParam;

class TextTables : public TestWithParam<std::uint64_t> {
 protected:
  SeededHead head_{GetParam(), 150, 6};
  AimGrid grid_{head_.table({-150, -101.3, -33.1, 0.1, 47, 120, 150}, {-90, -10, 0, 33.3, 90})};
};
INSTANTIATE_TEST_SUITE_P(Seeds, TextTables, testing::Values(1, 2, 3, 4));

TEST_P(TextTables, CsvReadsBackToTheLastBit) {
  const AimGrid read = parseCsvTable(csvTable(grid_), "a.csv");
  EXPECT_EQ(read.x_mm(), grid_.x_mm());
  EXPECT_EQ(read.y_mm(), grid_.y_mm());
  EXPECT_EQ(read.d_mm(), grid_.d_mm());
}

TEST_P(TextTables, TheControllerTakesTheCsv) {
  const auto table = planner::CorrectionTable::parse(csvTable(grid_), "a.csv");
  EXPECT_EQ(table.unit(), planner::CorrectionTable::Unit::kMm);
  EXPECT_EQ(table.at({-33.1, 33.3}).d, grid_.d_mm(2, 3));
}

TEST_P(TextTables, GridTextReadsBackToTheLastBitAndGoesOnOutside) {
  const AimGrid read = parseGridText(gridText(grid_), "a.txt");
  EXPECT_EQ(read.d_mm(), grid_.d_mm());
  EXPECT_EQ(read.between(), Between::kBilinear);
  EXPECT_EQ(read.at_mm({180, 0}), Vector2d(2 * grid_.d_mm(6, 2) - *read.at_mm({120, 0})));
}

TEST_P(TextTables, NinePointsHoldABiquadraticFieldAndTheirSignIsHowWrong) {
  const AimGrid nine = resampled(grid_, {-90, 0, 90}, {-90, 0, 90}, Between::kHermite, Outside::kRefused);
  const AimGrid read = parseNinePointText(ninePointText(nine), "a.fixup");
  EXPECT_LT(farthest_mm(nine, read), 1e-12);
}

TEST(NinePoints, ReadsGlasesExample) {
  const std::string text =
      "# Assumed origin (adjusted later with X and Y entries).\n0 0 0 0\n\n-32 0 -2 0\n32 0 2.5 0\n0 -32 0 "
      "-2.5\n"
      "0 32 0 3.5\n\n-32 -32 2 -4\n-32 32 1.5 5\n32 32 0 5.5\n32 -32 -2 -4\n";
  const AimGrid grid = parseNinePointText(text, "local.fixup");
  EXPECT_EQ(grid.x_mm(), (std::vector<double>{-80, 0, 80}));
  EXPECT_EQ(grid.at_mm({80, 0}), Vector2d(-2.5, 0));
  EXPECT_EQ(grid.at_mm({-80, 80}), Vector2d(-1.5, -5));
  EXPECT_EQ(faultsOf([&] { (void)parseNinePointText(text + "Y 0.5 70.025\n", "a"); }),
            "a:13: a point of a mount's axis is no part of the head's correction: take the X and Y lines "
            "out, and turn "
            "the mount's frame in the job");
}

TEST(NinePoints, FollowsAScaleAndAFieldThatIsNotSquare) {
  const AimGrid grid = SeededHead(5, 100).table(evenly(-100, 100, 9), evenly(-50, 50, 5));
  const AimGrid read = parseNinePointText(ninePointText(grid, {.mm_per_index = 3.0}), "a.fixup");
  EXPECT_EQ(read.area_W_mm().max(), Vector2d(96, 48));
  EXPECT_LT((*read.at_mm({96, 48}) - *grid.at_mm({96, 48})).norm(), 1e-12);
  EXPECT_THROW((void)ninePointText(grid, {.mm_per_index = 51.0}), std::invalid_argument);
  EXPECT_NE(faultsOf([&] {
              (void)parseNinePointText(ninePointText(grid), "a", {.mm_per_index = 9.0});
            }).find("the file's mm_per_index is 1.5625, asked for is 9"),
            std::string::npos);
}

TEST(GridText, TakesNodesInAnyOrder) {
  const AimGrid grid =
      parseGridText("1 1 0.1 4 ; a comment\n0 0 0.2 3\n\n# another\n1 0 0.3 2\n0 1 0.4 1\n", "a");
  EXPECT_EQ(grid.d_mm(0, 1), Vector2d(0.4, 1));
  EXPECT_EQ(grid.d_mm(1, 0), Vector2d(0.3, 2));
}

}  // namespace
}  // namespace kerfbench::calibrate

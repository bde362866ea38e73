// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/aim_grid.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "firmware_under_test/planner/head/correction.h"
#include "hil/calibrate/tables/csv_table.h"
#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

const std::vector<double> kUnevenX{-50, -31, -20, -4, 3, 17, 29, 44, 50};
const std::vector<double> kUnevenY{-40, -28, -11, 2, 13, 30, 40};

TEST(AimGrid, BilinearHoldsAPlaneAndItsTwistExactly) {
  const auto at = [](const Vector2d& p) {
    return Vector2d(1 + 0.1 * p.x() - 0.2 * p.y() + 0.003 * p.x() * p.y(), 2 - 0.05 * p.x());
  };
  std::vector<Vector2d> d;
  for (const double y : kUnevenY) {
    for (const double x : kUnevenX) d.push_back(at({x, y}));
  }
  const AimGrid grid(kUnevenX, kUnevenY, d, Between::kBilinear, Outside::kLinear);
  for (const Vector2d& p : {Vector2d(-50, -40), Vector2d(50, 40), Vector2d(7.3, -19), Vector2d(-60, 45)})
    EXPECT_LT((*grid.at_mm(p) - at(p)).norm(), 1e-12) << p.transpose();
}

TEST(AimGrid, HermiteOnThreeByThreeIsBiquadratic) {
  const auto at = [](const Vector2d& p) {
    return Vector2d(p.x() * p.x() * p.y() * p.y() - 3 * p.y() * p.y(), p.x() * p.x() + p.x() * p.y());
  };
  const std::vector<double> x{-1, 0.2, 1};
  const std::vector<double> y{-2, 0, 1};
  std::vector<Vector2d> d;
  for (const double py : y) {
    for (const double px : x) d.push_back(at({px, py}));
  }
  const AimGrid grid(x, y, d, Between::kHermite, Outside::kRefused);
  for (const Vector2d& p : {Vector2d(-0.7, -1.1), Vector2d(0.9, 0.4), Vector2d(0.1, -0.3)})
    EXPECT_LT((*grid.at_mm(p) - at(p)).norm(), 1e-12) << p.transpose();
}

TEST(AimGrid, IsTheControllersSurfaceBetweenUnevenNodes) {
  const AimGrid grid = SeededHead(3, 50).table(kUnevenX, kUnevenY);
  const auto controller = planner::CorrectionTable::parse(csvTable(grid), "table.csv");
  const CounterRandom random(3, 9);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector2d p(100 * random.uniform(2 * i) - 50, 80 * random.uniform(2 * i + 1) - 40);
    EXPECT_LT((*grid.at_mm(p) - controller.at(p).d).norm(), 1e-12) << p.transpose();
  }
}

TEST(AimGrid, OutsideIsRefusedClampedOrGoesOn) {
  const std::vector<double> x{0, 1, 3};
  const std::vector<Vector2d> d{{0, 0}, {1, 0}, {5, 0}, {0, 1}, {1, 1}, {5, 1}, {0, 2}, {1, 2}, {5, 2}};
  const AimGrid grid(x, {0, 1, 2}, d, Between::kBilinear, Outside::kRefused);
  EXPECT_FALSE(grid.at_mm({3.001, 1}));
  EXPECT_TRUE(grid.at_mm({3.0 + 1e-12, 1}));
  EXPECT_EQ(grid.with(Between::kBilinear, Outside::kClamped).at_mm({4, 3}), Vector2d(5, 2));
  EXPECT_EQ(grid.with(Between::kBilinear, Outside::kLinear).at_mm({4, 3}), Vector2d(7, 3));
  EXPECT_EQ(grid.with(Between::kHermite, Outside::kLinear).at_mm({4, 3}), Vector2d(7, 3));
  EXPECT_FALSE(grid.at_mm({NAN, 1}));
}

TEST(AimGrid, SaysEverythingThatIsWrong) {
  try {
    const AimGrid grid({0, 1, 1}, {0, NAN}, {{0, 0}, {1, INFINITY}}, Between::kHermite, Outside::kRefused);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(),
                 "x must ascend: 1 after 1\ny has 2 nodes, not 3 to 1025\ny of node 1 is not finite\n"
                 "2 values for 3 x 2 nodes\nvalue 1 is not finite");
  }
}

TEST(AimGrid, ResamplingOutsideNamesTheNode) {
  const AimGrid grid = SeededHead(1, 50).table(evenly(-50, 50, 9), evenly(-50, 50, 9));
  try {
    (void)resampled(grid, evenly(-50, 51, 3), evenly(-50, 50, 3), Between::kHermite, Outside::kRefused);
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(),
                 "the node (51, -50) mm lies outside of the table, which covers x -50 … 50, y -50 … 50 mm");
  }
}

}  // namespace
}  // namespace kerfbench::calibrate

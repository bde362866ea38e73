// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/correction_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/planner/correction.h"
#include "tests/hil/calibrate/head/campaign.h"
#include "twin/base/random.h"

namespace kerfbench::hil {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using testing::HasSubstr;

const AlignedBox2d kArea{Vector2d(-100, -60), Vector2d(140, 80)};

CorrectionGrid gridOf(int columns, int rows, const auto& d) {
  std::vector<Vector2d> values;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector2d share(1.0 * column / (columns - 1), 1.0 * row / (rows - 1));
      values.push_back(d(kArea.min() + share.cwiseProduct(kArea.sizes())));
    }
  }
  return {kArea, columns, rows, values};
}

Vector2d somewhere(std::uint64_t i) {
  const CounterRandom random(11, 2);
  return kArea.min() + Vector2d(random.uniform(2 * i), random.uniform(2 * i + 1)).cwiseProduct(kArea.sizes());
}

HeadFit someFit(double field_mm) {
  const test::SimulatedHead head(test::HeadKind::kTwoMirror300, test::Beyond::kNothing, 9);
  const test::MarkedSheet sheet = test::mark(head, 9, 0, nullptr, {}, 9);
  HeadFitOptions options;
  options.field_W_mm = {Vector2d::Constant(-0.5 * field_mm), Vector2d::Constant(0.5 * field_mm)};
  return fitHead(pairMarks(sheet.aimed, sheet.seen).observations, head.nominal(), head.design(), options);
}

// Written apart from the planner's: a table is only good if both read it alike.
TEST(CorrectionGrid, IsTheSurfaceThatThePlannerUses) {
  const auto wild = [](const Vector2d& p) {
    return Vector2d(std::sin(0.05 * p.x()) * std::cos(0.03 * p.y()), 1e-4 * p.x() * p.y());
  };
  const CorrectionGrid grid = gridOf(9, 7, wild);
  std::string csv = "x_mm,y_mm,dx_mm,dy_mm\n";
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 9; ++column) {
      const Vector2d p = grid.place_W_mm(column, row), d = grid.d_mm(column, row);
      csv += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", p.x(), p.y(), d.x(), d.y());
    }
  }
  const auto table = planner::CorrectionTable::parse(csv, "grid");
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector2d p = 1.2 * somewhere(i);  // Some beyond the grid.
    EXPECT_LT((grid.at_mm(p) - table.at(p).d).norm(), 1e-12);
  }
}

TEST(CorrectionGrid, IsExactForCubics) {
  const auto cubic = [](const Vector2d& p) {
    return Vector2d(1e-6 * p.x() * p.x() * p.x() + 0.01 * p.y(),
                    1e-10 * std::pow(p.x(), 3) * std::pow(p.y(), 3) - 1.0);
  };
  const CorrectionGrid grid = gridOf(5, 6, cubic);
  for (std::uint64_t i = 0; i < 200; ++i)
    EXPECT_LT((grid.at_mm(somewhere(i)) - cubic(somewhere(i))).norm(), 1e-10);
}

TEST(CorrectionGrid, RefusesWhatIsNoGrid) {
  EXPECT_THROW(CorrectionGrid(kArea, 4, 5, std::vector<Vector2d>(20)), std::invalid_argument);
  EXPECT_THROW(CorrectionGrid(kArea, 5, 5, std::vector<Vector2d>(24)), std::invalid_argument);
  EXPECT_THROW(CorrectionGrid(AlignedBox2d(), 5, 5, std::vector<Vector2d>(25)), std::invalid_argument);
}

TEST(CorrectionTable, LandsWhereWantedBetweenItsNodesAndOnTheRim) {
  const HeadFit fit = someFit(300);
  const AlignedBox2d field(Vector2d::Constant(-150), Vector2d::Constant(150));
  for (const double error_mm : {0.01, 0.001, 0.0001}) {
    const auto table = correctionTable(fit, {.field_W_mm = field, .interpolation_error_mm = error_mm});
    EXPECT_LE(table.interpolation_error_mm, error_mm);
    EXPECT_TRUE(table.grid.area_W_mm().contains(field));
    const CounterRandom random(5, 5);
    for (std::uint64_t i = 0; i < 400; ++i) {
      Vector2d p = 300.0 * Vector2d(random.uniform(2 * i) - 0.5, random.uniform(2 * i + 1) - 0.5);
      if (i % 4 == 0) p.x() = 150.0;
      // Middles of cells are where it was looked for; elsewhere a cell is hardly worse.
      EXPECT_LT((fit.spotOf(p + table.grid.at_mm(p))->p_W_mm - p).norm(), 1.5 * error_mm);
    }
  }
}

TEST(CorrectionTable, PlacesOutOfReachAreRefused) {
  const HeadFit fit = someFit(300);
  const AlignedBox2d too_wide(Vector2d(-20000, -150), Vector2d(20000, 150));
  try {
    correctionTable(fit, {.field_W_mm = too_wide});
    FAIL();
  } catch (const HeadCalibrationError& e) {
    EXPECT_THAT(e.what(), HasSubstr("the beam does not get to (-20800.0, -156.0) mm"));
  }
  EXPECT_THROW(correctionTable(fit, {.field_W_mm = {}}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/correction_table.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/head/correction.h"
#include "hil/calibrate/tables/csv_table.h"
#include "tests/hil/calibrate/head/campaign.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using testing::HasSubstr;

HeadFit someFit(double field_mm) {
  const test::SimulatedHead head(test::HeadKind::kTwoMirror300, test::Beyond::kNothing, 9);
  const test::MarkedSheet sheet = test::mark(head, 9, 0, nullptr, {}, 9);
  HeadFitOptions options;
  options.field_W_mm = {Vector2d::Constant(-0.5 * field_mm), Vector2d::Constant(0.5 * field_mm)};
  return fitHead(pairMarks(sheet.aimed, sheet.seen).observations, head.nominal(), head.design(), options);
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
      // The error was searched in the middles of cells; elsewhere a cell is hardly worse.
      EXPECT_LT((fit.spotOf(p + table.grid.at_mm(p).value())->p_W_mm - p).norm(), 1.5 * error_mm);
    }
  }
}

TEST(CorrectionTable, IsFineEnoughForAControllerThatKnowsNothingButItsNodes) {
  // The table's formula has no lens of this kind: the error of nine nodes is small, their uncertainty is not.
  const test::SimulatedHead head(test::HeadKind::kFTheta300, test::Beyond::kNothing, 2);
  const test::MarkedSheet sheet = test::mark(head, 9, 0, nullptr, {}, 2);
  HeadFitOptions options;
  options.field_W_mm = {Vector2d::Constant(-157), Vector2d::Constant(157)};
  const HeadFit fit =
      fitHead(pairMarks(sheet.aimed, sheet.seen).observations, head.nominal(), head.design(), options);
  const auto coarse = correctionTable(fit, {.field_W_mm = options.field_W_mm, .cubics_differ_mm = INFINITY});
  const auto fine = correctionTable(fit, {.field_W_mm = options.field_W_mm});
  const auto reader = [](const AimGrid& grid) {
    return planner::CorrectionTable::parse(csvTable(grid), "table").coarseness().error;
  };
  EXPECT_GT(reader(coarse.grid), 0.01);
  EXPECT_LE(reader(fine.grid), 0.005);
  EXPECT_GT(fine.grid.x_mm().size(), coarse.grid.x_mm().size());
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
}  // namespace kerfbench::calibrate

// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/table_loss.h"

#include <gtest/gtest.h>

#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

/// Table d = c (x², 0) at even nodes, as finely as the original needs to hold it.
AimGrid parabola(std::size_t columns, Between between, double half_mm = 50.0) {
  const auto x = evenly(-half_mm, half_mm, columns);
  const auto y = evenly(-half_mm, half_mm, 5);
  std::vector<Vector2d> d;
  for (std::size_t row = 0; row < y.size(); ++row) {
    for (const double px : x) d.emplace_back(1e-3 * px * px, 0);
  }
  return {x, y, d, between, Outside::kRefused};
}

// The chord of a parabola with second derivative f'' is off by f'' h² / 8 in the middle of a cell h.
TEST(TableLoss, OfAChordIsTheTextbooks) {
  const TableLoss loss = tableLoss(parabola(5, Between::kHermite), parabola(11, Between::kBilinear));
  const double expected_um = 1000 * 2e-3 * 10 * 10 / 8;
  EXPECT_LT(loss.nodes.max_um, 1e-9);
  EXPECT_NEAR(loss.mid_cell.max_um, expected_um, 1e-9);
  EXPECT_NEAR(loss.mid_cell.rms_um, expected_um, 1e-9);
  EXPECT_EQ(loss.mid_cell.places, 40U);
  EXPECT_NEAR(loss.rim.max_um, expected_um, 1e-9);
  EXPECT_LT(loss.rim.rms_um, expected_um);
  EXPECT_NEAR(loss.anywhere.max_um, expected_um, 1e-9);
  EXPECT_EQ(loss.not_covered, 0U);
  EXPECT_DOUBLE_EQ(loss.covered_share, 1.0);
}

TEST(TableLoss, NamesThePlaceOfTheWorst) {
  const auto places = evenly(-50, 50, 11);
  std::vector<Vector2d> d(121, Vector2d::Zero());
  const AimGrid flat(places, places, d, Between::kBilinear, Outside::kRefused);
  d[3 * 11 + 7] = {0.03, 0.04};
  const AimGrid bumped(places, places, d, Between::kBilinear, Outside::kRefused);
  const TableLoss loss = tableLoss(flat, bumped);
  EXPECT_NEAR(loss.nodes.max_um, 50.0, 1e-9);
  EXPECT_EQ(loss.nodes.worst_W_mm, Vector2d(20, -20));
  EXPECT_NEAR(loss.nodes.rms_um, 50.0 / 11, 1e-9);
  EXPECT_NEAR(loss.mid_cell.max_um, 12.5, 1e-9);
  EXPECT_EQ(loss.rim.max_um, 0.0);
  EXPECT_NE(loss.text().find(
                "nodes (rounding): 50.000 µm at most, at (20.000, -20.000) mm; 4.545 µm RMS of 121 places"),
            std::string::npos)
      << loss.text();
}

TEST(TableLoss, CountsWhatTheOriginalDoesNotKnowAndWhatTheNewOneLacks) {
  const TableLoss wider = tableLoss(parabola(9, Between::kHermite), parabola(9, Between::kHermite, 60));
  EXPECT_GT(wider.not_covered, 0U);
  EXPECT_EQ(wider.rim.places, 0U);
  const TableLoss narrower = tableLoss(parabola(9, Between::kHermite), parabola(9, Between::kHermite, 40));
  EXPECT_EQ(narrower.not_covered, 0U);
  EXPECT_NEAR(narrower.covered_share, 0.64, 1e-12);
  EXPECT_NE(narrower.text().find("64.0 % of the original's area are covered"), std::string::npos);
}

}  // namespace
}  // namespace kerfbench::calibrate

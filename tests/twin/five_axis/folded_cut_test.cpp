// SPDX-License-Identifier: Apache-2.0
// What a program burns, against the closed form of a line cut by a Gaussian beam.
#include "twin/five_axis/folded_cut.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

FiveAxisDescription head() {
  FiveAxisDescription description;
  description.waist_radius_mm = 0.25;
  description.power_w = 57.88;
  description.feed_mm_s = 50.0;
  return description;
}

FoldedBlank level() {
  BlankFace face;
  face.outline_F_mm = Eigen::AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(40.0, 30.0));
  return {{face}, 0.25, 10.0};
}

FiveAxisMove move(double x, double y, bool cuts, double a_rad = 0.0, double c_rad = 0.0) {
  return {{Vector3d(x, y, 0.0), a_rad, c_rad}, cuts};
}

TEST(FoldedCut, ALineHasTheFluenceAndTheWidthOfTheClosedForm) {
  const FoldedCut cut = cutFolded(head(), level(), {}, {move(5, 10, false), move(25, 10, true)});
  // F0 = sqrt(2/pi) P / (v w), and the board is severed to w sqrt(ln(F0 / F) / 2).
  const double peak = std::sqrt(2.0 / std::numbers::pi) * 57.88 / (50.0 * 0.25);
  EXPECT_NEAR(cut.sheets[0].fluenceAt({15.0, 10.0}), peak, 2e-3 * peak);
  const double half_mm = 0.25 * std::sqrt(0.5 * std::log(peak / 0.5));
  EXPECT_NEAR(half_mm, 0.25, 1e-4);
  EXPECT_GE(cut.sheets[0].depthAt({15.0, 10.0 + half_mm - 0.002}), 1.0);
  EXPECT_LT(cut.sheets[0].depthAt({15.0, 10.0 + half_mm + 0.002}), 1.0);
  EXPECT_NEAR(cut.cut_mm, 20.0, 1e-12);
  EXPECT_EQ(cut.missed_mm, 0.0);
  EXPECT_NEAR(cut.sheets[0].energyJ(), 57.88 * 20.0 / 50.0, 1e-3);
}

TEST(FoldedCut, WithTheBeamOffNothingIsBurnt) {
  const FoldedCut cut = cutFolded(head(), level(), {}, {move(5, 10, false), move(25, 10, false)});
  EXPECT_EQ(cut.sheets[0].energyJ(), 0.0);
}

TEST(FoldedCut, ATurnInOnePlaceBurnsOnlyWithPowerThatIsConstant) {
  const std::vector<FiveAxisMove> turn{move(20, 10, false), move(20, 10, true, 0.5, 0.0)};
  FiveAxisDescription description = head();
  EXPECT_EQ(cutFolded(description, level(), {}, turn).sheets[0].energyJ(), 0.0);
  description.power_follows_speed = false;
  const double burnt_j = cutFolded(description, level(), {}, turn).sheets[0].energyJ();
  EXPECT_NEAR(burnt_j, 57.88 * 0.5 / description.turn_speed_rad_s, 1e-2);
}

TEST(FoldedCut, WhatMissesTheBlankIsCounted) {
  const FoldedCut cut = cutFolded(head(), level(), {}, {move(35, 10, false), move(50, 10, true)});
  EXPECT_NEAR(cut.missed_mm, 15.0 - 5.0 - 2.0 * 0.25, 0.05);
}

}  // namespace
}  // namespace kerfbench::twin

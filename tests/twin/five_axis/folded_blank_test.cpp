// SPDX-License-Identifier: Apache-2.0
// Where a beam meets the faces of a blank.
#include "twin/five_axis/folded_blank.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWaist_mm = 0.25;
constexpr double kRayleigh_mm = 12.0;

BlankFace faceAt(const Eigen::Isometry3d& X_WF) {
  return {X_WF, Eigen::AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(40.0, 30.0)), {}};
}

/// A face level at z = 0, and one that is folded down by an angle along its upper edge y = 30.
FoldedBlank edge(double angle_rad) {
  Eigen::Isometry3d level = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d folded = Eigen::Isometry3d::Identity();
  folded.linear() = Eigen::AngleAxisd(-angle_rad, Vector3d::UnitX()).toRotationMatrix();
  folded.translation() = Vector3d(0.0, 30.0, 0.0);
  return {{faceAt(level), faceAt(folded)}, kWaist_mm, kRayleigh_mm};
}

TEST(FoldedBlank, AnUprightBeamMeetsALevelFaceInACircleThatGrowsWithTheWay) {
  const auto spots = edge(0.5 * std::numbers::pi).meet({Vector3d(10.0, 10.0, 12.0), Vector3d::UnitZ()});
  ASSERT_EQ(spots.size(), 1U);
  EXPECT_EQ(spots[0].face, 0U);
  EXPECT_NEAR(spots[0].past_focus_mm, 12.0, 1e-12);
  EXPECT_NEAR(spots[0].footprint.radius_x_mm, kWaist_mm * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(spots[0].footprint.radius_y_mm, kWaist_mm * std::sqrt(2.0), 1e-12);
  EXPECT_LT((spots[0].footprint.p_SQ_mm - Vector2d(10.0, 10.0)).norm(), 1e-12);
}

TEST(FoldedBlank, AnAslantFaceIsMetInAnEllipseLongerByOneOverTheCosine) {
  const double angle_rad = 0.6;
  const FoldedBlank blank = edge(angle_rad);
  const Vector3d on_flap = blank.faces()[1].X_WF * Vector3d(20.0, 10.0, 0.0);
  const auto spots = blank.meet({on_flap, Vector3d::UnitZ()});
  ASSERT_EQ(spots.size(), 1U);
  EXPECT_EQ(spots[0].face, 1U);
  EXPECT_LT((spots[0].footprint.p_SQ_mm - Vector2d(20.0, 10.0)).norm(), 1e-9);
  EXPECT_NEAR(spots[0].footprint.radius_x_mm, kWaist_mm, 1e-9);
  EXPECT_NEAR(spots[0].footprint.radius_y_mm, kWaist_mm / std::cos(angle_rad), 1e-9);
  EXPECT_NEAR(spots[0].footprint.correlation, 0.0, 1e-9);
}

TEST(FoldedBlank, NextToAShallowFoldTheFlankReachesTheOtherFace) {
  const FoldedBlank blank = edge(0.4);
  EXPECT_EQ(blank.meet({Vector3d(20.0, 29.8, 0.0), Vector3d::UnitZ()}).size(), 2U);
  EXPECT_EQ(blank.meet({Vector3d(20.0, 29.0, 0.0), Vector3d::UnitZ()}).size(), 1U);
}

TEST(FoldedBlank, AFaceAlongTheBeamOrSeenFromBehindGetsNothing) {
  const FoldedBlank blank = edge(0.5 * std::numbers::pi);
  EXPECT_EQ(blank.meet({Vector3d(20.0, 29.99, 0.0), Vector3d::UnitZ()}).size(), 1U);
  EXPECT_TRUE(blank.meet({Vector3d(20.0, 10.0, 0.0), -Vector3d::UnitZ()}).empty());
  EXPECT_TRUE(blank.meet({Vector3d(20.0, -10.0, 0.0), Vector3d::UnitZ()}).empty());
}

TEST(FoldedBlank, TheFaceThatIsMetFirstShadowsTheOneBehindIt) {
  Eigen::Isometry3d below = Eigen::Isometry3d::Identity();
  below.translation().z() = -15.0;
  const FoldedBlank blank({faceAt(below), faceAt(Eigen::Isometry3d::Identity())}, kWaist_mm, kRayleigh_mm);
  const auto spots = blank.meet({Vector3d(20.0, 15.0, 0.0), Vector3d::UnitZ()});
  ASSERT_EQ(spots.size(), 1U);
  EXPECT_EQ(spots[0].face, 1U);
  // Beside the upper one the beam goes on to the lower one, as a stray burn.
  const auto aslant = blank.meet({Vector3d(45.0, 15.0, 0.0), Vector3d(0.6, 0.0, 0.8)});
  ASSERT_EQ(aslant.size(), 1U);
  EXPECT_EQ(aslant[0].face, 0U);
}

}  // namespace
}  // namespace kerfbench::twin

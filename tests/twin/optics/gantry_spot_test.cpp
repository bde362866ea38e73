// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

const Eigen::Vector2d kPlace_mm(12.5, -7.0);

TEST(GantrySpot, FallsStraightBelowTheNozzleAtAnyHeight) {
  for (const double height_mm : {-3.0, 0.0, 5.0}) {
    const auto spot = gantrySpot(kPlace_mm, {}, Surface({.height_mm = height_mm}), 0.0);
    ASSERT_TRUE(spot);
    EXPECT_EQ(spot->p_WQ_mm, kPlace_mm);
    EXPECT_EQ(spot->height_mm, height_mm);
    EXPECT_EQ(spot->radius_x_mm, spot->radius_y_mm);
    EXPECT_EQ(spot->correlation, 0.0);
  }
}

TEST(GantrySpot, HasTheSameCausticAsTheScanHeadAtRest) {
  const BeamDescription beam{.waist_radius_mm = 0.2, .rayleigh_mm = 8.0, .focus_z_mm = 1.5};
  const ScanHead head({}, beam);
  for (const double height_mm : {-20.0, 0.0, 1.5, 30.0}) {
    const Surface board({.height_mm = height_mm});
    const auto below_gantry = gantrySpot({0.0, 0.0}, beam, board, 0.0);
    const auto below_head = head.spotAt({0.0, 0.0}, {0.0, 0.0}, board, 0.0);
    ASSERT_TRUE(below_gantry && below_head);
    EXPECT_NEAR(below_gantry->radius_x_mm, below_head->radius_x_mm, 1e-12);
    EXPECT_NEAR(below_gantry->radius_y_mm, 0.2 * std::hypot(1.0, (height_mm - 1.5) / 8.0), 1e-12);
  }
}

TEST(GantrySpot, AnOffsetMovesItAndATiltMovesItWithTheHeight) {
  const BeamDescription beam{.offset_mm = {0.2, -0.1}, .tilt_rad = {0.003, 0.004}};
  const Eigen::Vector2d offset_mm(0.2, -0.1);
  const auto low = gantrySpot(kPlace_mm, beam, Surface(SurfaceDescription{}), 0.0);
  const auto high = gantrySpot(kPlace_mm, beam, Surface({.height_mm = 10.0}), 0.0);
  ASSERT_TRUE(low && high);
  EXPECT_NEAR((low->p_WQ_mm - kPlace_mm - offset_mm).norm(), 0.0, 1e-12);
  // The beam from above comes from -y if turned about +Wx, from +x if turned about +Wy.
  const Eigen::Vector2d lean = (high->p_WQ_mm - low->p_WQ_mm) / 10.0;
  EXPECT_NEAR(lean.norm(), std::tan(0.005), 1e-12);
  EXPECT_NEAR(lean.x() / lean.y(), 0.004 / -0.003, 1e-9);
}

TEST(GantrySpot, TiltedOrNotItsWaistLiesAtTheHeightOfFocus) {
  const BeamDescription beam{
      .waist_radius_mm = 0.2, .rayleigh_mm = 0.5, .focus_z_mm = 100.0, .tilt_rad = {0.0, 0.1}};
  const auto spot = gantrySpot(kPlace_mm, beam, Surface({.height_mm = 100.0}), 0.0);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->radius_y_mm, 0.2, 1e-12);
  EXPECT_NEAR(spot->radius_x_mm, 0.2 / std::cos(0.1), 1e-12);
}

TEST(GantrySpot, OnASlopeItIsStretchedOnlyAsSeenFromTheBeam) {
  // The spot on any slope is round when seen along Wz, which is the beam.
  const auto spot = gantrySpot(kPlace_mm, {.rayleigh_mm = INFINITY}, Surface({.slope = {0.1, -0.05}}), 0.0);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->radius_x_mm, 0.105, 1e-15);
  EXPECT_NEAR(spot->radius_y_mm, 0.105, 1e-15);
  EXPECT_NEAR(spot->correlation, 0.0, 1e-14);
  EXPECT_NEAR(spot->height_mm, 0.1 * 12.5 + 0.05 * 7.0, 1e-12);
}

TEST(GantrySpot, APlaceThatIsNoNumberHasNoSpot) {
  EXPECT_FALSE(gantrySpot({std::nan(""), 0.0}, {}, Surface(SurfaceDescription{}), 0.0));
  EXPECT_FALSE(gantrySpot({0.0, INFINITY}, {}, Surface(SurfaceDescription{}), 0.0));
}

}  // namespace
}  // namespace kerfbench::twin

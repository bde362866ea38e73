// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/scan_head.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

constexpr double kThrowMm = 500.0;
constexpr double kSpacingMm = 15.0;

std::optional<BeamSpot> spotOf(const ScanHead& head, double a_rad, double b_rad) {
  return head.spotAt(Eigen::AngleAxisd(a_rad, ScanHead::xMirrorAxis()).toRotationMatrix(),
                     Eigen::AngleAxisd(b_rad, ScanHead::yMirrorAxis()).toRotationMatrix());
}

TEST(ScanHead, ItsRayTraceGivesTheFormulaOfThePaperOverTheWholeField) {
  for (const double spacing_mm : {0.0, 15.0, 60.0}) {
    const ScanHead head(kThrowMm, spacing_mm);
    for (double a = -0.2; a <= 0.2; a += 0.0133) {
      for (double b = -0.2; b <= 0.2; b += 0.0171) {
        const auto spot = spotOf(head, a, b);
        ASSERT_TRUE(spot) << a << " " << b;
        const double y = kThrowMm * std::tan(2.0 * b);
        const double x = (std::hypot(kThrowMm, y) + spacing_mm) * std::tan(2.0 * a);
        EXPECT_NEAR(spot->p_WQ_mm.x(), x, 1e-9);
        EXPECT_NEAR(spot->p_WQ_mm.y(), y, 1e-9);
      }
    }
  }
}

TEST(ScanHead, AtRestTheBeamFallsStraightOnTheOrigin) {
  const auto spot = spotOf(ScanHead(kThrowMm, kSpacingMm), 0.0, 0.0);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->p_WQ_mm.norm(), 0.0, 1e-10);
  EXPECT_NEAR(spot->stretch_x, 1.0, 1e-12);
  EXPECT_NEAR(spot->stretch_y, 1.0, 1e-12);
}

TEST(ScanHead, APositiveAngleOfEachMirrorMovesTheSpotAlongItsOwnPositiveAxis) {
  const ScanHead head(kThrowMm, kSpacingMm);
  const auto x = spotOf(head, 0.01, 0.0);
  const auto y = spotOf(head, 0.0, 0.01);
  ASSERT_TRUE(x && y);
  EXPECT_NEAR(x->p_WQ_mm.x(), 515.0 * std::tan(0.02), 1e-9);
  EXPECT_NEAR(x->p_WQ_mm.y(), 0.0, 1e-9);
  EXPECT_NEAR(y->p_WQ_mm.x(), 0.0, 1e-9);
  EXPECT_NEAR(y->p_WQ_mm.y(), 500.0 * std::tan(0.02), 1e-9);
}

TEST(ScanHead, AMirrorTurnedTooFarGivesNoSpot) {
  const ScanHead head(kThrowMm, kSpacingMm);
  const double quarter = std::numbers::pi / 4.0;
  for (const double far_rad : {quarter, 0.9, 1.2, 2.0, 3.0, -quarter, -0.9, -1.2, -2.0, -3.0}) {
    EXPECT_FALSE(spotOf(head, far_rad, 0.0)) << far_rad;
    EXPECT_FALSE(spotOf(head, 0.0, far_rad)) << far_rad;
  }
  EXPECT_TRUE(spotOf(head, 0.3, 0.3));
}

TEST(ScanHead, TheFootprintIsTheBeamsCylinderCutByThePlane) {
  const ScanHead head(kThrowMm, kSpacingMm);
  for (const double a : {-0.17, 0.0, 0.11}) {
    for (const double b : {-0.13, 0.0, 0.19}) {
      const auto spot = spotOf(head, a, b);
      ASSERT_TRUE(spot);
      // The last ray's direction, as (sin 2a, cos 2a sin 2b, -cos 2a cos 2b).
      const Eigen::Vector3d k(std::sin(2 * a), std::cos(2 * a) * std::sin(2 * b),
                              -std::cos(2 * a) * std::cos(2 * b));
      const Eigen::Vector3d u = k.unitOrthogonal();
      const Eigen::Vector3d v = k.cross(u);
      double reach_x = 0.0;
      double reach_y = 0.0;
      for (int i = 0; i < 100000; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 100000;
        const Eigen::Vector3d rim = std::cos(angle) * u + std::sin(angle) * v;
        const Eigen::Vector3d on_plane = rim - rim.z() / k.z() * k;
        reach_x = std::max(reach_x, on_plane.x());
        reach_y = std::max(reach_y, on_plane.y());
      }
      EXPECT_NEAR(spot->stretch_x, reach_x, 1e-8);
      EXPECT_NEAR(spot->stretch_y, reach_y, 1e-8);
    }
  }
}

TEST(ScanHead, RefusesAHeadThatCannotBeBuilt) {
  EXPECT_THROW(ScanHead(0.0, 15.0), std::invalid_argument);
  EXPECT_THROW(ScanHead(-1.0, 15.0), std::invalid_argument);
  EXPECT_THROW(ScanHead(500.0, -1.0), std::invalid_argument);
  EXPECT_THROW(ScanHead(std::nan(""), 15.0), std::invalid_argument);
}

TEST(GantrySpot, FallsStraightBelowTheHead) {
  const BeamSpot spot = gantrySpot(12.5, -7.0);
  EXPECT_EQ(spot.p_WQ_mm, Eigen::Vector2d(12.5, -7.0));
  EXPECT_EQ(spot.stretch_x, 1.0);
  EXPECT_EQ(spot.stretch_y, 1.0);
}

}  // namespace
}  // namespace kerfbench::twin

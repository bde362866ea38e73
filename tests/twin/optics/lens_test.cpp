// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

const Eigen::Vector2d kStill = Eigen::Vector2d::Zero();

std::optional<BeamSpot> spotOf(const LensDescription& lens, const Eigen::Vector2d& mirror_rad,
                               double height_mm = 0.0, const BeamDescription& beam = {}) {
  return ScanHead({.lens = lens}, beam).spotAt(mirror_rad, kStill, Surface({.height_mm = height_mm}), 0.0);
}

Eigen::Vector2d place(const LensDescription& lens, const Eigen::Vector2d& mirror_rad,
                      double height_mm = 0.0) {
  return spotOf(lens, mirror_rad, height_mm).value().p_WQ_mm;
}

TEST(Lens, FThetaIsExactOnItsAxesAndBarrelAndPincushionInTheCorners) {
  const LensDescription lens{.focal_length_mm = 500.0};
  EXPECT_NEAR((place(lens, {0.15, 0.0}) - Eigen::Vector2d(150.0, 0.0)).norm(), 0.0, 1e-10);
  EXPECT_NEAR((place(lens, {0.0, -0.15}) - Eigen::Vector2d(0.0, -150.0)).norm(), 0.0, 1e-10);
  EXPECT_NEAR((place(lens, {0.0, 0.0})).norm(), 0.0, 1e-10);
  EXPECT_NEAR(place(lens, {0.15, 0.15}).x(), 152.22, 0.005);
  EXPECT_NEAR(place(lens, {0.15, 0.15}).y(), 145.42, 0.005);
}

TEST(Lens, ItsCoefficientsBendFTheta) {
  EXPECT_NEAR(place({.focal_length_mm = 500.0, .k1 = -0.02}, {0.15, 0.0}).x(), 149.73, 1e-9);
  EXPECT_NEAR(place({.focal_length_mm = 500.0, .k2 = 0.1}, {0.15, 0.0}).x(), 150.0 * (1.0 + 0.1 * 0.0081),
              1e-9);
}

TEST(Lens, ItsFocalPlaneDoesNotCareWhereTheMirrorsAre) {
  const LensDescription lens{.focal_length_mm = 400.0};
  const ScanHeadDescription near{.throw_mm = 450.0, .mirror_spacing_mm = 10.0, .lens = lens};
  const ScanHeadDescription far{.throw_mm = 600.0, .mirror_spacing_mm = 50.0, .lens = lens};
  const Surface board(SurfaceDescription{});
  const auto from_near = ScanHead(near, {}).spotAt({0.1, -0.1}, kStill, board, 0.0);
  const auto from_far = ScanHead(far, {.offset_mm = {3.0, -2.0}}).spotAt({0.1, -0.1}, kStill, board, 0.0);
  ASSERT_TRUE(from_near && from_far);
  EXPECT_NEAR((from_near->p_WQ_mm - from_far->p_WQ_mm).norm(), 0.0, 1e-10);
}

TEST(Lens, OffTheFocalPlaneTheChiefRaysIncidenceShiftsTheSpot) {
  for (const double ratio : {0.0, 0.5, 1.0, -0.2}) {
    const LensDescription lens{.focal_length_mm = 500.0, .incidence_ratio = ratio};
    const double shift = place(lens, {0.15, 0.0}, -2.0).x() - place(lens, {0.15, 0.0}).x();
    EXPECT_NEAR(shift, 2.0 * std::tan(ratio * 0.3), 1e-11) << ratio;
  }
}

TEST(Lens, DecentredItMovesTheFieldAndTiltedItTurnsTheFocalPlane) {
  const LensDescription straight{.focal_length_mm = 500.0};
  const LensDescription beside{.focal_length_mm = 500.0, .decentre_mm = {1.5, -0.5}};
  const Eigen::Vector2d moved = place(beside, {0.1, 0.12}) - place(straight, {0.1, 0.12});
  EXPECT_NEAR((moved - Eigen::Vector2d(1.5, -0.5)).norm(), 0.0, 1e-10);

  // A lens that is turned about its principal point moves the spot at rest in second order only: the
  // telecentric beam leaves along the lens's axis, displaced by f (tilt - tan tilt cos tilt …).
  const double tilt = 1e-3;
  const LensDescription tilted{.focal_length_mm = 500.0, .tilt_rad = {0.0, tilt}};
  EXPECT_LT(place(tilted, {0.0, 0.0}).norm(), 500.0 * tilt * tilt);
  // The waist then lies in a plane turned alike: it rises on one side of the field, and falls on the other.
  const BeamDescription beam{.waist_radius_mm = 0.1, .rayleigh_mm = 5.0};
  const LensDescription telecentric{
      .focal_length_mm = 500.0, .tilt_rad = {0.0, 0.02}, .incidence_ratio = 0.0};
  for (const double side : {-1.0, 1.0}) {
    const double waist_mm = -side * 150.0 * std::tan(0.02);  // The turn is about +Wy: +x goes down.
    const auto in_focus = spotOf(telecentric, {side * 0.15, 0.0}, waist_mm, beam);
    const auto out_of_focus = spotOf(telecentric, {side * 0.15, 0.0}, -waist_mm, beam);
    ASSERT_TRUE(in_focus && out_of_focus);
    EXPECT_NEAR(in_focus->radius_y_mm, 0.1, 1e-3);
    EXPECT_GT(out_of_focus->radius_y_mm, 0.14);
  }
}

TEST(Lens, KeepsAFlatFieldInFocus) {
  const BeamDescription beam{.waist_radius_mm = 0.1, .rayleigh_mm = 5.0, .focus_z_mm = 1.0};
  const LensDescription telecentric{.focal_length_mm = 500.0, .incidence_ratio = 0.0};
  for (const double angle : {0.0, 0.07, 0.15}) {
    const auto spot = spotOf(telecentric, {angle, angle}, 1.0, beam);
    ASSERT_TRUE(spot);
    EXPECT_NEAR(spot->radius_x_mm, 0.1, 1e-12);
    EXPECT_NEAR(spot->radius_y_mm, 0.1, 1e-12);
    const auto lower = spotOf(telecentric, {angle, angle}, 0.0, beam);
    EXPECT_NEAR(lower.value().radius_x_mm, 0.1 * std::hypot(1.0, 0.2), 1e-12);
  }
  // The incidence is oblique: the ray is longer by its cosine, and the ellipse stretched by it.
  const LensDescription oblique{.focal_length_mm = 500.0};
  const auto spot = spotOf(oblique, {0.15, 0.0}, 0.0, beam);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->radius_y_mm, 0.1 * std::hypot(1.0, 0.2 / std::cos(0.3)), 1e-12);
  EXPECT_NEAR(spot->radius_x_mm, spot->radius_y_mm / std::cos(0.3), 1e-12);
}

TEST(Lens, LosesBeamsBeyondItsField) {
  const LensDescription lens{.focal_length_mm = 500.0};
  EXPECT_TRUE(spotOf(lens, {0.5 * LensDescription::kMaxFieldAngle_rad - 1e-6, 0.0}));
  EXPECT_FALSE(spotOf(lens, {0.5 * LensDescription::kMaxFieldAngle_rad + 1e-6, 0.0}));
  EXPECT_FALSE(spotOf(lens, {0.3, 0.3}));
  EXPECT_FALSE(spotOf(lens, {0.1, 0.1}, 600.0)) << "the board is above the lens";
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/surface.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

const SurfaceDescription kAll{.height_mm = 0.7,
                              .slope = {0.02, -0.03},
                              .curvature_1_mm = {2e-4, -1e-4},
                              .flutter_mm = 0.3,
                              .flutter_hz = 12.0,
                              .flutter_wavelength_mm = 180.0,
                              .flutter_phase_rad = 0.4};

TEST(Surface, IsTheSumOfHeightSlopeCurlAndFlutter) {
  const Eigen::Vector2d p(40.0, -30.0);
  EXPECT_EQ(Surface(SurfaceDescription{}).height_mm(p, 3.0), 0.0);
  EXPECT_NEAR(Surface({.height_mm = 0.7}).height_mm(p, 0.0), 0.7, 1e-15);
  EXPECT_NEAR(Surface({.slope = {0.02, -0.03}}).height_mm(p, 0.0), 0.8 + 0.9, 1e-14);
  EXPECT_NEAR(Surface({.curvature_1_mm = {2e-4, -1e-4}}).height_mm(p, 0.0), 0.16 - 0.045, 1e-14);
  const SurfaceDescription wave{.flutter_mm = 0.3, .flutter_hz = 10.0, .flutter_wavelength_mm = 160.0};
  // The wave at x = 40 is a quarter behind: -cos(2 pi f t).
  EXPECT_NEAR(Surface(wave).height_mm(p, 0.0), -0.3, 1e-12);
  EXPECT_NEAR(Surface(wave).height_mm(p, 0.025), 0.0, 1e-12);
  EXPECT_NEAR(Surface(wave).height_mm(p, 0.05), 0.3, 1e-12);
}

TEST(Surface, TheFlutterTravelsAlongTheBeltAtItsWaveSpeed) {
  SurfaceDescription wave = kAll;
  wave.slope = {0.0, 0.0};
  wave.curvature_1_mm = {0.0, 0.0};
  const Surface surface(wave);
  const double speed_mm_s = wave.flutter_hz * wave.flutter_wavelength_mm;
  for (double x = -200.0; x < 200.0; x += 17.0) {
    EXPECT_NEAR(surface.height_mm({x, 5.0}, 0.3), surface.height_mm({x + 0.01 * speed_mm_s, 5.0}, 0.31),
                1e-12);
  }
}

TEST(Surface, ItsSlopeIsTheDerivativeOfItsHeight) {
  const Surface surface(kAll);
  const CounterRandom random(1, 8);
  constexpr double kStep_mm = 1e-3;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Eigen::Vector2d p(150.0 * random.normal(3 * i), 150.0 * random.normal(3 * i + 1));
    const double time_s = random.uniform(3 * i + 2);
    const SurfacePoint point = surface.at(p, time_s);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep_mm * Eigen::Vector2d::Unit(axis);
      const double rise = surface.height_mm(p + step, time_s) - surface.height_mm(p - step, time_s);
      EXPECT_NEAR(point.slope[axis], rise / (2.0 * kStep_mm), 1e-10);
    }
  }
}

// Plane surfaces in closed form, all others by Newton: the meeting lies on both the line and the surface.
TEST(Surface, ALineMeetsItWhereBothAre) {
  SurfaceDescription plane = kAll;
  plane.curvature_1_mm = {0.0, 0.0};
  plane.flutter_mm = 0.0;
  SurfaceDescription curled = kAll;
  curled.flutter_mm = 0.0;
  const CounterRandom random(1, 9);
  for (const SurfaceDescription& description : {SurfaceDescription{.height_mm = 0.7}, plane, curled, kAll}) {
    const Surface surface(description);
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Eigen::Vector2d foot(150.0 * random.normal(5 * i), 150.0 * random.normal(5 * i + 1));
      const Eigen::Vector2d run(0.4 * random.normal(5 * i + 2), 0.4 * random.normal(5 * i + 3));
      const double time_s = random.uniform(5 * i + 4);
      const auto point = surface.meet(foot, run, time_s);
      ASSERT_TRUE(point);
      EXPECT_NEAR((point->p_WQ_mm - foot - point->height_mm * run).norm(), 0.0, 1e-12);
      const SurfacePoint there = surface.at(point->p_WQ_mm, time_s);
      ASSERT_NEAR(point->height_mm, there.height_mm, 1e-12) << foot.transpose() << " " << run.transpose();
      EXPECT_NEAR((point->slope - there.slope).norm(), 0.0, 1e-12);
    }
  }
}

TEST(Surface, TheShortWaysForPlaneSurfacesAgreeWithTheLongOneToRounding) {
  const CounterRandom random(1, 10);
  for (const SurfaceDescription& description :
       {SurfaceDescription{.height_mm = -0.4}, SurfaceDescription{.height_mm = 2.0, .slope = {0.1, -0.07}}}) {
    SurfaceDescription not_plane = description;
    not_plane.curvature_1_mm = {1e-300, 0.0};
    const Surface shortly(description);
    const Surface at_length(not_plane);
    for (std::uint64_t i = 0; i < 500; ++i) {
      const Eigen::Vector2d foot(150.0 * random.normal(4 * i), 150.0 * random.normal(4 * i + 1));
      const Eigen::Vector2d run(0.3 * random.normal(4 * i + 2), 0.3 * random.normal(4 * i + 3));
      const auto a = shortly.meet(foot, run, 0.0);
      const auto b = at_length.meet(foot, run, 0.0);
      ASSERT_TRUE(a && b);
      EXPECT_NEAR(a->height_mm, b->height_mm, 1e-13);
      EXPECT_NEAR((a->p_WQ_mm - b->p_WQ_mm).norm(), 0.0, 1e-13);
    }
  }
}

TEST(Surface, ALineThatPassesBesideItMeetsNothing) {
  // The surfaces z = x²/200 and x = x0 + z have no point in common for x0 > 50.
  const Surface bowl({.curvature_1_mm = {0.01, 0.0}});
  EXPECT_TRUE(bowl.meet({49.0, 0.0}, {1.0, 0.0}, 0.0));
  EXPECT_FALSE(bowl.meet({51.0, 0.0}, {1.0, 0.0}, 0.0));
  EXPECT_FALSE(bowl.meet({1e4, 0.0}, {1.0, 0.0}, 0.0));
  EXPECT_FALSE(bowl.meet({std::nan(""), 0.0}, {1.0, 0.0}, 0.0));
}

TEST(Surface, RefusesOneThatCannotBe) {
  EXPECT_THROW(Surface({.slope = {0.2, 0.0}}), std::invalid_argument);
  EXPECT_THROW(Surface({.flutter_mm = -1.0}), std::invalid_argument);
  EXPECT_THROW(Surface({.height_mm = std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin

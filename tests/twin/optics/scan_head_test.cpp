// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/scan_head.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kThrow_mm = 500.0;
const Surface kBoard{SurfaceDescription{}};

std::optional<BeamSpot> spotOf(const ScanHeadDescription& head, double x_rad, double y_rad) {
  return ScanHead(head, {}).spotAt({x_rad, y_rad}, Eigen::Vector2d::Zero(), kBoard, 0.0);
}

TEST(ScanHead, ItsRayTraceGivesTheFormulaOfThePaperOverTheWholeField) {
  for (const double spacing_mm : {0.0, 15.0, 60.0}) {
    const ScanHead head({.throw_mm = kThrow_mm, .mirror_spacing_mm = spacing_mm}, {});
    for (double a = -0.2; a <= 0.2; a += 0.0133) {
      for (double b = -0.2; b <= 0.2; b += 0.0171) {
        const auto spot = head.spotAt({a, b}, Eigen::Vector2d::Zero(), kBoard, 0.0);
        ASSERT_TRUE(spot) << a << " " << b;
        const double y = kThrow_mm * std::tan(2.0 * b);
        const double x = (std::hypot(kThrow_mm, y) + spacing_mm) * std::tan(2.0 * a);
        EXPECT_NEAR(spot->p_WQ_mm.x(), x, 1e-9);
        EXPECT_NEAR(spot->p_WQ_mm.y(), y, 1e-9);
        EXPECT_EQ(spot->height_mm, 0.0);
      }
    }
  }
}

TEST(ScanHead, WithTheYMirrorFirstTheFormulaChangesItsAxes) {
  const ScanHead head({.throw_mm = kThrow_mm, .mirror_spacing_mm = 15.0, .y_mirror_first = true}, {});
  for (double a = -0.2; a <= 0.2; a += 0.0133) {
    for (double b = -0.2; b <= 0.2; b += 0.0171) {
      const auto spot = head.spotAt({a, b}, Eigen::Vector2d::Zero(), kBoard, 0.0);
      ASSERT_TRUE(spot) << a << " " << b;
      const double x = kThrow_mm * std::tan(2.0 * a);
      const double y = (std::hypot(kThrow_mm, x) + 15.0) * std::tan(2.0 * b);
      EXPECT_NEAR(spot->p_WQ_mm.x(), x, 1e-9);
      EXPECT_NEAR(spot->p_WQ_mm.y(), y, 1e-9);
    }
  }
}

TEST(ScanHead, AtRestTheBeamFallsStraightOnTheOrigin) {
  for (const bool y_first : {false, true}) {
    const auto spot = spotOf({.y_mirror_first = y_first}, 0.0, 0.0);
    ASSERT_TRUE(spot);
    EXPECT_NEAR(spot->p_WQ_mm.norm(), 0.0, 1e-10);
    EXPECT_NEAR(spot->radius_x_mm, BeamDescription{}.waist_radius_mm, 1e-12);
    EXPECT_NEAR(spot->radius_y_mm, BeamDescription{}.waist_radius_mm, 1e-12);
    EXPECT_NEAR(spot->correlation, 0.0, 1e-12);
  }
}

TEST(ScanHead, AMirrorTurnedTooFarGivesNoSpot) {
  const double quarter = std::numbers::pi / 4.0;
  for (const bool y_first : {false, true}) {
    const ScanHeadDescription head{.y_mirror_first = y_first};
    for (const double far_rad : {quarter, 0.9, 1.2, 2.0, 3.0, -quarter, -0.9, -1.2, -2.0, -3.0}) {
      EXPECT_FALSE(spotOf(head, far_rad, 0.0)) << far_rad;
      EXPECT_FALSE(spotOf(head, 0.0, far_rad)) << far_rad;
    }
    EXPECT_TRUE(spotOf(head, 0.3, 0.3));
    // The first mirror, turned by a right angle, throws the beam away from the last one, whose plane, endless
    // as it is, would still meet that ray's extension backwards.
    for (const double a : {-2.0 * quarter, 2.0 * quarter}) {
      for (const double b : {-2.0 * quarter, 2.0 * quarter})
        EXPECT_FALSE(spotOf(head, a, b)) << a << " " << b;
    }
  }
}

// The result must be finite numbers or no spot, whatever the motors do: a diverging servo must not put NaN on
// the sheet.
TEST(ScanHead, NoAngleEverGivesANumberThatIsNotFinite) {
  const CounterRandom random(1, 2);
  ScanHeadDescription with_lens;
  with_lens.lens = LensDescription{.focal_length_mm = 500.0};
  const Surface curled({.slope = {0.1, -0.1}, .curvature_1_mm = {0.01, -0.01}, .flutter_mm = 1.0});
  std::size_t hits = 0;
  for (const ScanHeadDescription& description : {ScanHeadDescription{}, with_lens}) {
    const ScanHead head(description, {});
    for (std::uint64_t i = 0; i < 50000; ++i) {
      const double size = std::pow(10.0, 8.0 * random.uniform(3 * i) - 2.0);
      const Eigen::Vector2d angles(size * random.normal(3 * i + 1), size * random.normal(3 * i + 2));
      for (const Surface& surface : {kBoard, curled}) {
        const auto spot = head.spotAt(angles, Eigen::Vector2d::Zero(), surface, 1e-3);
        if (!spot) continue;
        ++hits;
        ASSERT_TRUE(spot->p_WQ_mm.allFinite() && std::isfinite(spot->height_mm)) << angles.transpose();
        ASSERT_TRUE(std::isfinite(spot->radius_x_mm) && spot->radius_x_mm > 0) << angles.transpose();
        ASSERT_TRUE(std::isfinite(spot->radius_y_mm) && spot->radius_y_mm > 0) << angles.transpose();
        ASSERT_LT(std::abs(spot->correlation), 1.0) << angles.transpose();
      }
    }
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      EXPECT_FALSE(head.spotAt({bad, 0.0}, Eigen::Vector2d::Zero(), kBoard, 0.0));
      EXPECT_FALSE(head.spotAt({0.0, bad}, Eigen::Vector2d::Zero(), kBoard, 0.0));
      EXPECT_FALSE(head.spotAt({0.0, 0.0}, {bad, 0.0}, kBoard, 0.0));
      EXPECT_FALSE(head.spotAt({0.0, 0.0}, {0.0, 0.0}, curled, bad));
    }
  }
  EXPECT_GT(hits, 1000U);
}

TEST(ScanHead, ZeroAndScaleOfAMirrorAreAChangeOfItsAngle) {
  const CounterRandom random(5, 1);
  for (const bool y_first : {false, true}) {
    for (std::uint64_t i = 0; i < 100; ++i) {
      ScanHeadDescription head{.y_mirror_first = y_first};
      head.x.zero_rad = 0.02 * random.normal(6 * i);
      head.y.zero_rad = 0.02 * random.normal(6 * i + 1);
      head.x.scale = 1.0 + 0.05 * random.normal(6 * i + 2);
      head.y.scale = 1.0 + 0.05 * random.normal(6 * i + 3);
      const double a = 0.1 * random.normal(6 * i + 4);
      const double b = 0.1 * random.normal(6 * i + 5);
      const auto spot = spotOf(head, a, b);
      const auto same = spotOf({.y_mirror_first = y_first}, head.x.zero_rad + head.x.scale * a,
                               head.y.zero_rad + head.y.scale * b);
      ASSERT_TRUE(spot && same);
      EXPECT_EQ(spot->p_WQ_mm, same->p_WQ_mm);
      EXPECT_EQ(spot->radius_x_mm, same->radius_x_mm);
    }
  }
}

TEST(ScanHead, AMovedFrameTakesTheSpotAlongAndMeetsTheSurfaceThere) {
  const ScanHead head({}, {});
  const Eigen::Vector2d shift_mm(0.3, -0.2);
  const auto still = head.spotAt({0.1, 0.05}, Eigen::Vector2d::Zero(), kBoard, 0.0);
  const auto moved = head.spotAt({0.1, 0.05}, shift_mm, kBoard, 0.0);
  ASSERT_TRUE(still && moved);
  EXPECT_NEAR((moved->p_WQ_mm - still->p_WQ_mm - shift_mm).norm(), 0.0, 1e-12);
  const Surface slope({.slope = {0.05, 0.02}});
  const auto on_slope = head.spotAt({0.1, 0.05}, shift_mm, slope, 0.0);
  ASSERT_TRUE(on_slope);
  EXPECT_NEAR(on_slope->height_mm, slope.height_mm(on_slope->p_WQ_mm, 0.0), 1e-12);
}

TEST(ScanHead, RefusesAHeadThatCannotBeBuiltAndNamesEveryFault) {
  EXPECT_THROW(ScanHead({.throw_mm = 0.0}, {}), std::invalid_argument);
  EXPECT_THROW(ScanHead({.mirror_spacing_mm = -1.0}, {}), std::invalid_argument);
  try {
    ScanHead({.throw_mm = std::nan("")}, {.waist_radius_mm = -1.0});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "head.throw_mm must be in (0, 100000], is nan; beam.waist_radius_mm must be in (0, 100], is -1");
  }
}

}  // namespace
}  // namespace kerfbench::twin

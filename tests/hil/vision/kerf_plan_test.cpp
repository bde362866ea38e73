// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "hil/dieline/geometry.h"

namespace kerfbench::vision {
namespace {

/// Two lines of 20 mm at a right angle, joined by a fillet of this radius.
dieline::Dieline elbow(double radius_mm) {
  dieline::Dieline dieline;
  const auto add = [&](dieline::Curve curve) {
    dieline::Entity& entity = dieline.entities.emplace_back();
    entity.id = static_cast<int>(dieline.entities.size()) - 1;
    entity.curve = std::move(curve);
  };
  add(dieline::LineCurve{{-20.0, 0.0}, {-radius_mm, 0.0}});
  add(dieline::ArcCurve{{-radius_mm, radius_mm}, radius_mm, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi});
  add(dieline::LineCurve{{0.0, radius_mm}, {0.0, 20.0}});
  return dieline;
}

/// Stations that count as at a corner, of all entities.
std::ptrdiff_t nearCorner(const dieline::Dieline& dieline) {
  KerfScanOptions options;
  options.station_pitch_mm = 0.1;
  std::ptrdiff_t count = 0;
  for (const EntityPlan& plan : planKerf(dieline, options).entities)
    count += std::ranges::count_if(plan.stations, [](const Station& s) { return s.near_corner; });
  return count;
}

TEST(KerfPlan, AFilletOfNextToNoRadiusIsACornerToItsCalipers) {
  EXPECT_GE(nearCorner(elbow(0.1)), 8) << "the fillet and 0.4 mm of each line";
  EXPECT_EQ(nearCorner(elbow(0.5)), 0) << "a bend that calipers can measure";
}

TEST(KerfPlan, BothLegsOfACornerAreNearIt) {
  dieline::Dieline dieline;
  dieline.entities.emplace_back().curve = dieline::LineCurve{{-20.0, 0.0}, {0.0, 0.0}};
  dieline.entities.emplace_back().curve = dieline::LineCurve{{0.0, 0.0}, {0.0, 20.0}};
  dieline.entities.back().id = 1;
  const KerfPlan plan = planKerf(dieline, KerfScanOptions{});
  ASSERT_EQ(plan.entities.size(), 2U);
  EXPECT_TRUE(plan.entities[0].stations.back().near_corner);
  EXPECT_TRUE(plan.entities[1].stations.front().near_corner);
  EXPECT_FALSE(plan.entities[0].stations.front().near_corner);
  EXPECT_FALSE(plan.entities[1].stations.back().near_corner);
}

TEST(KerfPlan, EndsMeetWithinTwoHundredthsOfAMillimetre) {
  const auto cornersAt = [](double apart_mm) {
    dieline::Dieline dieline;
    dieline.entities.emplace_back().curve = dieline::LineCurve{{-20.0, 0.0}, {0.0, 0.0}};
    dieline.entities.emplace_back().curve = dieline::LineCurve{{0.0, apart_mm}, {0.0, 20.0}};
    dieline.entities.back().id = 1;
    return planKerf(dieline, KerfScanOptions{}).corners.size();
  };
  EXPECT_EQ(cornersAt(0.018), 1U);
  EXPECT_EQ(cornersAt(0.022), 0U);
}

TEST(KerfPlan, AHoleAsSmallIsMeasuredByItsOwnCalipers) {
  dieline::Dieline dieline;
  dieline.entities.emplace_back().curve = dieline::ArcCurve{{0.0, 0.0}, 0.1, 0.0, 2.0 * std::numbers::pi};
  EXPECT_EQ(nearCorner(dieline), 0);
}

}  // namespace
}  // namespace kerfbench::vision

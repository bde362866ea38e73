// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

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

/// Stations of a crease of 20 mm that count as at a corner, with a cut from cut_from_mm to cut_to_mm along
/// it.
std::vector<double> nearCornerOfACrease(double cut_from_mm, double cut_to_mm) {
  dieline::Dieline dieline;
  dieline::Entity& crease = dieline.entities.emplace_back();
  crease.curve = dieline::LineCurve{{0.0, 0.0}, {20.0, 0.0}};
  crease.process = dieline::Process::kCrease;
  dieline::Entity& cut = dieline.entities.emplace_back();
  cut.id = 1;
  cut.curve = dieline::LineCurve{{cut_from_mm, 0.0}, {cut_to_mm, 0.0}};
  KerfScanOptions options;
  options.station_pitch_mm = 0.1;
  std::vector<double> places_mm;
  const KerfPlan plan = planKerf(dieline, options);
  for (const Station& station : plan.entities.front().stations)
    if (station.near_corner) places_mm.push_back(station.station_mm);
  EXPECT_TRUE(std::ranges::none_of(plan.entities.back().stations, &Station::near_corner)) << "the cut's own";
  return places_mm;
}

TEST(KerfPlan, ACreaseUnderACutIsNotJudgedByTheCutsLight) {
  const std::vector<double> covered_mm = nearCornerOfACrease(5.0, 5.8);
  ASSERT_FALSE(covered_mm.empty());
  EXPECT_NEAR(covered_mm.front(), 4.95, 0.1);
  EXPECT_NEAR(covered_mm.back(), 5.85, 0.1);
  EXPECT_GE(covered_mm.size(), 9U);
}

TEST(KerfPlan, ACreaseThatGoesOnWhereACutEndsIsJudgedFromThereOn) {
  const std::vector<double> covered_mm = nearCornerOfACrease(-20.0, 0.0);
  EXPECT_TRUE(covered_mm.empty() || covered_mm.back() <= 0.11);
}

TEST(KerfPlan, AHoleAsSmallIsMeasuredByItsOwnCalipers) {
  dieline::Dieline dieline;
  dieline.entities.emplace_back().curve = dieline::ArcCurve{{0.0, 0.0}, 0.1, 0.0, 2.0 * std::numbers::pi};
  EXPECT_EQ(nearCorner(dieline), 0);
}

}  // namespace
}  // namespace kerfbench::vision

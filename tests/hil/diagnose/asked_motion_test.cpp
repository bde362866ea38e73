// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/asked_motion.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::diagnose {
namespace {

constexpr double kTop_mm_s = 100.0;
constexpr double kAcceleration_mm_s2 = 1000.0;
constexpr double kLine_mm = 40.0;

/// A line along x cut from rest to rest on a belt, with the light that `light` gives at each speed.
template <typename Light>
AskedCut lineWith(Light light, double belt_mm_s = 0.0) {
  AskedCut cut;
  const double ramp_s = kTop_mm_s / kAcceleration_mm_s2;
  const double end_s = kLine_mm / kTop_mm_s + ramp_s;
  for (double t_s = 0.0; t_s + kSpan_s <= end_s; t_s += kSpan_s) {
    const double from_end_s = std::min({t_s, end_s - t_s, ramp_s});
    const double speed_mm_s = kAcceleration_mm_s2 * from_end_s;
    const double ramped_mm = 0.5 * kAcceleration_mm_s2 * from_end_s * from_end_s;
    const double way_mm = t_s < ramp_s           ? ramped_mm
                          : t_s < end_s - ramp_s ? kTop_mm_s * (t_s - 0.5 * ramp_s)
                                                 : kLine_mm - ramped_mm;
    cut.push_back({{10.0 + way_mm + belt_mm_s * t_s, 5.0}, 10.0 + belt_mm_s * t_s, light(speed_mm_s)});
  }
  return cut;
}
double steady(double) { return 0.3; }
double following(double speed_mm_s) { return 0.3 * speed_mm_s / kTop_mm_s; }

TEST(SteadyPower, ALaserThatShinesAsLongWhereTheBeamIsSlowIsFound) {
  for (const double belt_mm_s : {0.0, 60.0}) {
    const auto power = steadyPower({lineWith(steady, belt_mm_s)});
    ASSERT_TRUE(power) << belt_mm_s;
    EXPECT_NEAR(power->light_share, 1.0, 1e-9);
    EXPECT_GT(power->slow_share, 0.1);
    EXPECT_LT(power->slow_share, 0.5);
    EXPECT_THAT(sentenceOf(*power),
                testing::StartsWith("The laser keeps its power where the beam is slow: at 3"));
  }
}

TEST(SteadyPower, OneThatFollowsTheSpeedIsNot) {
  EXPECT_FALSE(steadyPower({lineWith(following)}));
  // Half of it follows: corners get too much, but the laser does not ignore the speed.
  EXPECT_FALSE(steadyPower({lineWith([](double v) { return 0.5 * (steady(v) + following(v)); })}));
}

TEST(SteadyPower, NothingIsSaidOfAJobWithoutSlowPlaces) {
  AskedCut cut;
  for (int i = 0; i < 100; ++i) cut.push_back({{0.5 * i, 0.0}, 0.0, 0.3});
  EXPECT_FALSE(steadyPower({cut}));
  EXPECT_FALSE(steadyPower({}));
  EXPECT_FALSE(steadyPower({lineWith([](double) { return 0.0; })})) << "a gate without light";
}

dieline::Dieline lineAtHeight(double y_mm) {
  dieline::Dieline dieline;
  dieline.entities.push_back(
      {0, dieline::LineCurve{{0, y_mm}, {kLine_mm, y_mm}}, dieline::Process::kCut, "CUT", ""});
  return dieline;
}

TEST(AskedMotion, TellsHowFarThePulsesLeadOffTheDrawingAndHowHardTheyPush) {
  for (const double belt_mm_s : {0.0, 60.0}) {
    const auto asked = askedMotion({lineWith(steady, belt_mm_s)}, lineAtHeight(5.03), PrintLayout{});
    ASSERT_TRUE(asked);
    EXPECT_NEAR(asked->off_mm, 0.03, 1e-9);
    EXPECT_NEAR(asked->acceleration_mm_s2.x(), kAcceleration_mm_s2, 0.01 * kAcceleration_mm_s2);
    EXPECT_EQ(asked->acceleration_mm_s2.y(), 0.0);
  }
}

TEST(AskedMotion, ACutOfTwoInstantsTellsNothing) {
  EXPECT_FALSE(askedMotion({AskedCut(2)}, lineAtHeight(5.0), PrintLayout{}));
  EXPECT_FALSE(askedMotion({AskedCut(3)}, dieline::Dieline{}, PrintLayout{}));
}

}  // namespace
}  // namespace kerfbench::diagnose

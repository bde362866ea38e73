// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/model.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libraries.h"

namespace kerfbench::planner {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const PowerWish& wish) {
  try {
    const PowerModel model(test::steel(), test::tube(), wish);
  } catch (const PowerError& error) {
    return error.what();
  }
  return {};
}

TEST(PowerModel, TheChainLeadsFromDepthToDepth) {
  const Material steel = test::steel();
  const LaserTube tube = test::tube();
  std::mt19937_64 random(21);
  for (int i = 0; i < 2000; ++i) {
    const double spot = std::uniform_real_distribution<double>(0.2, 0.5)(random);
    const double depth = std::uniform_real_distribution<double>(0.01, 0.48)(random);
    const PowerModel model(steel, tube, {spot, depth, std::nullopt});
    const PowerModel::Speeds range = model.speedsFor(depth);
    const double speed =
        std::uniform_real_distribution<double>(range.lowest_mm_s, range.highest_mm_s)(random);
    const PowerModel::Setting s = model.at(speed, depth);
    EXPECT_EQ(s.limit, PowerModel::Limit::kNone);
    // The paper's equations in forward order: u, P_out, P_ua, D.
    const double power_w = model.laser().power.at(s.control);
    EXPECT_NEAR(model.material().depth.at(power_w / (speed * spot)), depth, 1e-9);
    EXPECT_EQ(s.depth_mm, depth);
  }
}

TEST(PowerModel, SaysWhatDepthIsReachedWhereTheLaserSaturates) {
  const auto model = test::steelModel(0.2);
  const PowerModel::Speeds range = model->speedsFor(0.2);
  double before = 1.0;
  for (int i = 0; i < 72; ++i) {
    const double speed = std::pow(1.1, i);
    const PowerModel::Setting s = model->at(speed, 0.2);
    EXPECT_GE(s.power_w, model->laser().least_w);
    EXPECT_LE(s.power_w, model->laser().most_w);
    EXPECT_LE(s.depth_mm, before) << "faster is never deeper";
    before = s.depth_mm;
    if (speed < range.lowest_mm_s) {
      EXPECT_EQ(s.limit, PowerModel::Limit::kLeast);
      EXPECT_GT(s.depth_mm, 0.2);
    } else if (speed > range.highest_mm_s) {
      EXPECT_EQ(s.limit, PowerModel::Limit::kMost);
      EXPECT_LT(s.depth_mm, 0.2);
    } else {
      EXPECT_EQ(s.depth_mm, 0.2);
    }
  }
  EXPECT_EQ(model->at(1e-12, 0.2).depth_mm, 0.48) << "saturated, however slow";
  EXPECT_LT(model->at(1e9, 0.2).depth_mm, 1e-6);
}

TEST(PowerModel, BytesAreTheNearestThatKeepTheLimits) {
  const auto model = test::steelModel(0.2);
  for (int byte = 0; byte <= 255; ++byte) {
    const auto told = model->byteFor(byte / 255.0 * 100.0);
    EXPECT_GE(model->powerOf(told), 4.0);
    EXPECT_LE(model->powerOf(told), 78.0);
    const double power_w = model->powerOf(std::uint8_t(byte));
    const bool within = power_w >= 4.0 && power_w <= 78.0;
    EXPECT_TRUE(!within || told == byte) << byte;
  }
  EXPECT_EQ(model->byteFor(-1e308), model->byteFor(0.0));
  EXPECT_EQ(model->byteFor(1e308), model->byteFor(100.0));
}

TEST(PowerModel, RefusesDepthsBeyondSaturationAndNamesTheGreatest) {
  EXPECT_EQ(refusal({0.2, 0.48, std::nullopt}), "");
  EXPECT_THAT(refusal({0.2, 0.4801, std::nullopt}),
              HasSubstr("mild steel: it saturates at 15 J/mm2, 0.48 mm is the greatest"));
}

TEST(PowerModel, RefusesEverythingWrongAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      refusal({nan, -1.0, 3.0}),
      AllOf(HasSubstr("spot diameter must be in"), HasSubstr("depth must be at least 0.0001 mm, but is -1"),
            HasSubstr("half depth: 3 mm cannot be had"), HasSubstr("must be less than the depth of cuts")));
  for (const double bad : {nan, 0.0, -0.2, 1e-300, 1e308, std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(refusal({0.2, bad, std::nullopt}), "") << bad;
    EXPECT_NE(refusal({bad, 0.2, std::nullopt}), "") << bad;
    EXPECT_NE(refusal({0.2, 0.2, bad}), "") << bad;
  }
  LaserTube narrow = test::tube();
  narrow.least_w = 50.0;
  narrow.most_w = 50.1;
  EXPECT_THROW(PowerModel(test::steel(), narrow, {0.2, 0.2, std::nullopt}), PowerError);
  const auto model = test::steelModel(0.2);
  for (const double bad : {nan, 0.0, -1.0}) EXPECT_THROW((void)model->at(bad, 0.2), std::domain_error);
  EXPECT_THROW((void)model->at(100.0, 0.5), std::domain_error);
}

TEST(PowerModel, TheTableEndsForTheOddestLibraries) {
  for (const double steepest : {5e-324, 1e-300, 1e-6, 1.0, 1e6}) {
    const Material odd{"odd", "", Curve({{0.0, 0.0}, {steepest, 1.0}})};
    const PowerModel model(odd, test::tube(), {0.01, 0.5, std::nullopt});
    const std::vector<double> speeds = tableSpeeds(model, 0.5);
    EXPECT_GE(speeds.size(), 2U);
    EXPECT_LE(speeds.size(), 40U);
    for (const double speed : speeds) EXPECT_TRUE(speed > 0.0 && speed <= 2e6) << speed;
    EXPECT_THAT(powerTable(model, 0.5, speeds), HasSubstr("odd with CO2 tube"));
  }
}

TEST(PowerModel, ZTellsTheDepth) {
  const PowerModel told(test::steel(), test::tube(), {0.2, 0.3, 0.1});
  EXPECT_EQ(told.depthOf(1.0, 0.5), 0.3);
  EXPECT_EQ(told.depthOf(0.5, 0.5), 0.1);
  EXPECT_DOUBLE_EQ(told.depthOf(0.25, 0.5), 0.075);
  EXPECT_EQ(told.depthOf(1.0, 1.0), 0.3) << "Z1 cuts, whatever half_z is";
  EXPECT_DOUBLE_EQ(test::steelModel(0.3)->depthOf(0.5, 0.5), 0.15);
}

}  // namespace
}  // namespace kerfbench::planner

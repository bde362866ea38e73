// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/speed_profile.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

const SpeedProfile kRamps(180.0, {{1.0, 180.0}, {1.5, 230.0}, {2.5, 200.0}});

TEST(SpeedProfile, RunsThroughItsPointsInStraightLines) {
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(-1.0), 180.0);
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(0.7), 180.0);
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(1.25), 205.0);
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(1.5), 230.0);
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(2.0), 215.0);
  EXPECT_DOUBLE_EQ(kRamps.speed_mm_s(9.0), 200.0);
}

TEST(SpeedProfile, ItsTravelIsTheIntegralOfItsSpeed) {
  constexpr double kStep_s = 1e-3;
  double travel_mm = kRamps.travel_mm(-0.5);
  EXPECT_DOUBLE_EQ(travel_mm, -90.0);
  for (int i = -500; i < 4000; ++i) {
    // The midpoint is exact for straight lines, whose ends lie on the grid.
    travel_mm += kRamps.speed_mm_s((i + 0.5) * kStep_s) * kStep_s;
    ASSERT_NEAR(kRamps.travel_mm((i + 1) * kStep_s), travel_mm, 1e-9) << i;
  }
}

TEST(SpeedProfile, WithoutChangesIsConstant) {
  const SpeedProfile line(60.0);
  EXPECT_EQ(line.travel_mm(12.345), 60.0 * 12.345);
  EXPECT_EQ(line.speed_mm_s(12.345), 60.0);
}

TEST(SpeedProfile, RefusesTimesThatDoNotAscend) {
  EXPECT_THROW(SpeedProfile(1.0, {{0.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(SpeedProfile(1.0, {{2.0, 2.0}, {1.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(SpeedProfile(1.0, {{std::nan(""), 2.0}}), std::invalid_argument);
  EXPECT_THROW(SpeedProfile(std::numeric_limits<double>::infinity(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin

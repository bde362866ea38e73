// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/limit_switches.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

class LimitSwitchesTest : public testing::Test {
 protected:
  std::vector<SensorEdge> at(double x_mm, double x_speed, double y_mm = 0.0, double y_speed = 0.0) {
    std::vector<SensorEdge> edges;
    switches.predict({MotionForecast{1000, x_mm, x_speed, 0.0}, MotionForecast{1000, y_mm, y_speed, 0.0}},
                     1000 + kQuantum, edges);
    return edges;
  }
  LimitSwitches switches{kRate, {-2.0, -3.0}, {2.0, 3.0}};
};

void expectEdge(const std::vector<SensorEdge>& edges, Signal signal, bool level, double after_s) {
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].signal, signal);
  EXPECT_EQ(edges[0].level, level);
  EXPECT_NEAR(static_cast<double>(edges[0].tick - 1000), after_s * 16e6, 1.001);
}

TEST_F(LimitSwitchesTest, TripWhereTheAxisPassesTheEndOfItsTravel) {
  expectEdge(at(1.98, 100.0), Signal::kLimitX, true, 0.2e-3);
}

TEST_F(LimitSwitchesTest, SayNothingWhileTheAxisStaysWhereItIs) {
  EXPECT_TRUE(at(1.9, 100.0).empty());
  ASSERT_EQ(at(1.99, 100.0).size(), 1U);
  EXPECT_TRUE(at(2.5, 0.0).empty());
  EXPECT_TRUE(at(3.0, -100.0).empty());
}

TEST_F(LimitSwitchesTest, ReleaseOnTheWayBack) {
  ASSERT_EQ(at(2.01, 100.0).size(), 1U);
  expectEdge(at(2.03, -100.0), Signal::kLimitX, false, 0.3e-3);
  ASSERT_EQ(at(-2.01, -100.0).size(), 1U);
  expectEdge(at(-2.01, 100.0), Signal::kLimitX, false, 0.1e-3);
}

TEST_F(LimitSwitchesTest, BothEndsOfYShareAnotherPin) {
  expectEdge(at(0.0, 0.0, -2.99, -100.0), Signal::kLimitY, true, 0.1e-3);
  expectEdge(at(0.0, 0.0, -3.01, 100.0), Signal::kLimitY, false, 0.1e-3);
  expectEdge(at(0.0, 0.0, 2.96, 100.0), Signal::kLimitY, true, 0.4e-3);
}

TEST_F(LimitSwitchesTest, AnAxisThatStartsBeyondTripsAtOnce) {
  expectEdge(at(5.0, 0.0), Signal::kLimitX, true, 1.0 / 16e6);
}

TEST_F(LimitSwitchesTest, WhatAForecastPromisedTooEarlyIsTakenBackAtOnce) {
  ASSERT_EQ(at(1.96, 100.0).size(), 1U);
  expectEdge(at(1.995, 0.0), Signal::kLimitX, false, 1.0 / 16e6);
}

}  // namespace
}  // namespace kerfbench::twin

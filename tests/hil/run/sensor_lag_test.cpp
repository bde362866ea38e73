// SPDX-License-Identifier: Apache-2.0
#include "hil/run/sensor_lag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::run {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TickRate kRate{1, 1'000'000'000};
constexpr Tick kMs = 1'000'000;
constexpr double kLimit_s = 100e-6;
const std::vector<Signal> kSignals{Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark, Signal::kLimitX,
                                   Signal::kInterlock};

class SensorLagTest : public testing::Test {
 protected:
  /// Test with a belt that runs forward: an edge each millisecond, A leading; a mark from 20 to 40 ms.
  SensorLagTest() {
    for (int i = 0; i < 100; ++i) {
      const Signal signal = i % 2 == 0 ? Signal::kEncoderA : Signal::kEncoderB;
      due.push_back({static_cast<Tick>(i + 1) * kMs, signal, i % 4 < 2});
    }
    due.push_back({20 * kMs + 7, Signal::kPrintMark, true});
    due.push_back({40 * kMs + 7, Signal::kPrintMark, false});
    driven = due;
  }
  SensorLag found(Tick end = 200 * kMs) {
    using Edges = base::SpilledVector<SensorEdge>;
    return sensorLag(Edges(due), Edges(driven), kRate, end, kSignals, kLimit_s);
  }
  std::vector<SensorEdge> due;
  std::vector<SensorEdge> driven;
};

TEST_F(SensorLagTest, WhatWasDrivenInTimeIsMeasured) {
  for (SensorEdge& edge : driven) edge.tick += 30'000;
  driven[60].tick += 50'000;
  const SensorLag lag = found();
  EXPECT_THAT(lag.problems, IsEmpty());
  EXPECT_EQ(lag.lag.edges(), 102U);
  EXPECT_EQ(lag.lag.worst_ns(), 80'000);
  EXPECT_EQ(lag.lag.worstAt_ns(), 61 * kMs);
  EXPECT_NEAR(lag.lag.rms_ns(), 30'800, 500);
}

// A model that ran ahead of the clock can be early as well.
TEST_F(SensorLagTest, EarlyIsWorseThanALittleLate) {
  driven[10].tick -= 40'000;
  driven[11].tick += 20'000;
  EXPECT_EQ(found().lag.worst_ns(), -40'000);
}

TEST_F(SensorLagTest, AnEdgeThatCameTooLateIsAProblem) {
  driven[99].tick += 150'000;
  EXPECT_THAT(found().problems,
              ElementsAre(AllOf(HasSubstr("encoder: 1 of 100 edges of the machine's sensor were not driven"),
                                HasSubstr("within 100 us"), HasSubstr("by up to 150 us")),
                          HasSubstr("encoder: 1 of 100 edges that were driven are not the machine's")));
}

// All later edges belong to other counts then.
TEST_F(SensorLagTest, AMissingEdgeOfTheEncoderIsNotTakenForALateOne) {
  driven.erase(driven.begin() + 50, driven.begin() + 54);
  const SensorLag lag = found();
  ASSERT_EQ(lag.problems.size(), 2U);
  EXPECT_THAT(lag.problems[0], HasSubstr("encoder: 50 of 100 edges of the machine's"));
}

TEST_F(SensorLagTest, EdgesOfTheOtherSensorsAreMissedOneByOne) {
  std::erase_if(driven, [](const SensorEdge& e) { return e.signal == Signal::kPrintMark && e.level; });
  EXPECT_THAT(found().problems, ElementsAre(AllOf(HasSubstr("print_mark: 1 of 2 edges of the machine's"),
                                                  HasSubstr("the first at 0.020000 s"))));
}

TEST_F(SensorLagTest, AnEdgeThatTheMachineDidNotMakeIsAProblem) {
  driven.push_back({120 * kMs, Signal::kPrintMark, true});
  EXPECT_THAT(found().problems,
              ElementsAre(HasSubstr("print_mark: 1 of 3 edges that were driven are not the machine's")));
}

TEST_F(SensorLagTest, AGuardThatTheMachineDidNotOpenIsAProblemOfItsOwn) {
  driven.push_back({120 * kMs, Signal::kInterlock, true});
  EXPECT_THAT(found().problems, IsEmpty());
  EXPECT_THAT(found().guard_problems,
              ElementsAre(HasSubstr("interlock: 1 of 1 edges that were driven are not the machine's")));
}

// The belt trembles about one line of the disc: the same count again and again.
TEST_F(SensorLagTest, OfSeveralEdgesOfAKindTheNearestCounts) {
  for (const Tick at : {Tick{110}, Tick{120}, Tick{130}}) {
    due.push_back({at * kMs, Signal::kEncoderA, true});
    due.push_back({at * kMs + kMs, Signal::kEncoderA, false});
  }
  driven = due;
  driven[104].tick += 20'000;
  EXPECT_THAT(found().problems, IsEmpty());
  EXPECT_EQ(found().lag.worst_ns(), 20'000);
}

TEST_F(SensorLagTest, WhatWouldHaveComeAfterTheEndIsNotMissed) {
  driven.erase(driven.begin() + 99);
  EXPECT_THAT(found(100 * kMs + 50'000).problems, IsEmpty());
  EXPECT_FALSE(found(100 * kMs + 150'000).problems.empty());
}

// The switch answers to pins, which are known only after the hold-back.
TEST_F(SensorLagTest, ALimitSwitchMayBeLateByTheHoldBack) {
  due.push_back({50 * kMs, Signal::kLimitX, true});
  driven.push_back({72 * kMs, Signal::kLimitX, true});
  EXPECT_THAT(found().problems, IsEmpty());
  EXPECT_EQ(found().lag.worst_ns(), 0) << "what timers and calls cost";
  EXPECT_EQ(found().lag.edges(), 102U);
  EXPECT_EQ(found().switch_lag.worst_ns(), 22'000'000);
  driven.back().tick += 6 * kMs;
  EXPECT_EQ(found().problems.size(), 2U);
}

TEST_F(SensorLagTest, SignalsThatNobodyDrivesAreNotAskedFor) {
  due.push_back({50 * kMs, Signal::kInterlock, true});
  EXPECT_THAT(found().problems, IsEmpty());
}

TEST(SensorLagLimitTest, IsTenMicrometresOfTheFastestBeltOrWhatTheScenarioSays) {
  scenario::Scenario scenario;
  EXPECT_DOUBLE_EQ(sensorLagLimit_s(scenario), 1e-3);
  scenario.belt_speed_mm_s = 60;
  EXPECT_DOUBLE_EQ(sensorLagLimit_s(scenario), 0.01 / 60);
  scenario.belt_speed_changes = {{1.0, -200.0}};
  EXPECT_DOUBLE_EQ(sensorLagLimit_s(scenario), 50e-6);
  scenario.belt_speed_mm_s = 1;
  scenario.belt_speed_changes.clear();
  EXPECT_DOUBLE_EQ(sensorLagLimit_s(scenario), 1e-3);
  scenario.firmware.gpio.max_lag_s = 2e-4;
  EXPECT_DOUBLE_EQ(sensorLagLimit_s(scenario), 2e-4);
}

}  // namespace
}  // namespace kerfbench::run

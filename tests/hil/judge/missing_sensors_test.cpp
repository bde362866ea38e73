// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/missing_sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::judge {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kSpeed_mm_s = 60.0;

/// Two units on a web that moves by 200 mm; the eye marks pass their sensor after 10 and 90 mm.
class MissingSensors : public ::testing::Test {
 protected:
  MissingSensors() {
    test_case.scenario.belt_speed_mm_s = kSpeed_mm_s;
    test_case.scenario.print.units = 2;
    test_case.scenario.print.pitch_mm = 80.0;
    test_case.scenario.print.eye_mark_x_mm = 5.0;
    test_case.scenario.web_start_x_mm = -15.0;
    test_case.machine.controller.print_mark_sensor_x_mm = 0.0;
    test_case.machine.signals.assign(Signal::kEncoderA, {1, 0});
    test_case.machine.signals.assign(Signal::kEncoderB, {1, 1});
    test_case.machine.signals.assign(Signal::kPrintMark, {1, 2});
    for (int mm = 1; mm <= 200; ++mm) pins.belt.push_back({mm / kSpeed_mm_s, static_cast<double>(mm)});
    pins.gates = {{2.0, 3.0}};
    for (const Tick tick : {100U, 900U}) {
      recording.sensors.push_back({tick, Signal::kPrintMark, true});
      recording.sensors.push_back({tick + 10, Signal::kPrintMark, false});
    }
  }
  [[nodiscard]] std::vector<std::string> found() const { return missingSensors(test_case, recording, pins); }

  scenario::Case test_case;
  source::PinRecording recording;
  inspect::Evidence pins;
};

TEST_F(MissingSensors, AreNoneOfAWholeRecording) { EXPECT_THAT(found(), IsEmpty()); }

TEST_F(MissingSensors, AWebThatMovesHasEdgesOfItsEncoder) {
  pins.belt.clear();
  EXPECT_THAT(found(), ElementsAre(HasSubstr("no edge of its encoder")));
}

TEST_F(MissingSensors, EachEyeMarkThatPassedWasSeen) {
  recording.sensors = {recording.sensors[0], recording.sensors[1]};
  EXPECT_THAT(found(), ElementsAre(HasSubstr("2 printed eye marks passed their sensor")));
  recording.sensors.clear();
  EXPECT_THAT(found(), ElementsAre(HasSubstr("the edges of 0")));
}

TEST_F(MissingSensors, AMarkThatHasNotComeYetIsNotMissed) {
  recording.sensors = {recording.sensors[0], recording.sensors[1]};
  pins.gates = {{0.5, 1.0}};
  EXPECT_THAT(found(), IsEmpty());
}

TEST_F(MissingSensors, WhatIsNotWiredOrStandsIsNotMissed) {
  pins.belt.clear();
  recording.sensors.clear();
  test_case.machine.signals = {};
  EXPECT_THAT(found(), IsEmpty()) << "not wired";
  test_case.machine.signals.assign(Signal::kEncoderA, {1, 0});
  test_case.machine.signals.assign(Signal::kEncoderB, {1, 1});
  test_case.scenario.belt_by_controller = true;
  EXPECT_THAT(found(), IsEmpty()) << "fed between the cuts";
  test_case.scenario.belt_by_controller = false;
  test_case.scenario.belt_speed_mm_s = 0.0;
  EXPECT_THAT(found(), IsEmpty()) << "at rest";
}

}  // namespace
}  // namespace kerfbench::judge

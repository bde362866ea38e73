// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/controller_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <vector>

#include "firmware_under_test/controller/protocol.h"
#include "tests/hil/controller/spoken_frames.h"

namespace kerfbench::controller {
namespace {

using Said = inspect::ControllerEnd::Said;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TickRate kRate{1, 16'000'000};

TEST(UartListener, CountsTheBytesOfAReportThatIsNotWhole) {
  const std::vector<std::uint8_t> report = spokenState(KB_RUNNING, KB_OK, 0);
  UartListener ear;
  ear.hear(std::span(report).first(7), 1.0);
  ear.hear(std::span(report).subspan(7), 1.1);
  EXPECT_EQ(ear.strayBytes(), 0U) << "it came in two parts";
  std::vector<std::uint8_t> broken = report;
  broken.erase(broken.begin() + 9);
  ear.hear(broken, 2.0);
  ear.hear(report, 2.1);
  EXPECT_EQ(ear.strayBytes(), broken.size());
}

class ControllerReportTest : public testing::Test {
 protected:
  void says(std::uint8_t state, std::uint8_t fault, double at_s) {
    recording.uart.push_back({kRate.ticksAt(at_s), spokenState(state, fault, 0)});
  }
  [[nodiscard]] inspect::ControllerEnd end() const {
    return controllerEnd(UartListener(recording), PulseCounter(recording, {}), recording);
  }
  source::PinRecording recording{kRate, {}, {}, {}, 0, false};
  DialogFailure dialog;
  bool is_sound{true};
};

TEST_F(ControllerReportTest, TheFirstEndCountsAndIsToldInWords) {
  says(KB_RUNNING, KB_OK, 1.0);
  EXPECT_EQ(end().said, Said::kNothing);
  says(KB_STOPPED, KB_FAULT_BELT_FAST, 2.0);
  says(KB_IDLE, KB_OK, 3.0);
  EXPECT_EQ(end().said, Said::kStopped);
  EXPECT_EQ(end().time_s, 2.0);
  EXPECT_EQ(end().fault, "belt-fast");
  EXPECT_EQ(end().reason, "the belt is too fast for this job");
  EXPECT_TRUE(end().of_release);
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), IsEmpty());
}

TEST_F(ControllerReportTest, OnlyLineHostAndWhatNobodyKnowsAreNotTheReleases) {
  for (std::uint8_t fault = 0; fault < faultNames().size() + 2; ++fault) {
    recording.uart.clear();
    says(KB_STOPPED, fault, 2.0);
    const bool other =
        fault == KB_OK || fault == KB_FAULT_SILENT || fault == KB_FAULT_UART || fault >= faultNames().size();
    EXPECT_EQ(end().of_release, !other) << int{fault};
    EXPECT_EQ(unprovenEnd(end(), dialog, is_sound).empty(), !other) << int{fault};
  }
}

TEST_F(ControllerReportTest, AGuardThatWasOpenedIsNotTheReleases) {
  says(KB_STOPPED, KB_FAULT_INTERLOCK, 2.0);
  recording.sensors = {{1, Signal::kInterlock, true}};
  EXPECT_TRUE(end().of_release) << "it was closed";
  recording.sensors.push_back({kRate.ticksAt(1.9), Signal::kInterlock, false});
  EXPECT_FALSE(end().of_release);
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), HasSubstr("the guard was opened"));
}

TEST_F(ControllerReportTest, AHostThatGaveUpBeforeIsTheProblem) {
  says(KB_STOPPED, KB_FAULT_DRY, 2.0);
  dialog.reason = "at 1.900 s: the controller no longer answers";
  dialog.time_s = 1.9;
  EXPECT_EQ(unprovenEnd(end(), dialog, is_sound), dialog.reason);
  dialog.time_s = 2.1;
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), IsEmpty());
}

TEST_F(ControllerReportTest, NoEndIsAProblemAndEachOnlyOnce) {
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), HasSubstr("never said"));
  dialog.reason = "at 1.900 s: the controller has lost the program";
  EXPECT_EQ(unprovenEnd(end(), dialog, is_sound), dialog.reason);
  dialog.reason.clear();
  is_sound = false;  // The firmware crashed, for example.
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), IsEmpty());
}

TEST_F(ControllerReportTest, DoneAndAHostThatDisagreesIsAProblem) {
  says(KB_DONE, KB_OK, 2.0);
  EXPECT_EQ(end().said, Said::kDone);
  EXPECT_THAT(unprovenEnd(end(), dialog, is_sound), IsEmpty());
  dialog.reason = "at 2.100 s: the controller says that it is done before it has the whole program";
  EXPECT_EQ(unprovenEnd(end(), dialog, is_sound), dialog.reason);
}

}  // namespace
}  // namespace kerfbench::controller

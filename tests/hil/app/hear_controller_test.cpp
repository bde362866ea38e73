// SPDX-License-Identifier: Apache-2.0
#include "hil/app/hear_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "firmware_under_test/controller/protocol.h"
#include "tests/hil/app/spoken_frames.h"

namespace kerfbench::hil {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr TickRate kRate{1, 16'000'000};
constexpr const char* kGaveUp =
    "at 2.100 s: the controller says that it is done before it has the whole program";

class HearControllerTest : public testing::Test {
 protected:
  HearControllerTest() { run.recording.rate = kRate; }
  void says(std::uint8_t state, std::uint8_t fault, double at_s) {
    run.recording.uart.push_back({kRate.ticksAt(at_s), spokenState(state, fault, 0)});
  }
  void hear(LockstepResult& heard) {
    Conclusion conclusion;
    hearController(the_case, PreparedJob{}, run.recording, std::numeric_limits<double>::quiet_NaN(), heard,
                   conclusion);
  }
  /// What is made of the recording without a dialog.
  LockstepResult replayed() {
    LockstepResult replay;
    replay.problems = replay.recording.problems = run.recording.problems;
    hear(replay);
    return replay;
  }
  Case the_case;
  LockstepResult run;
};

// Its replay knew nothing of it, and passed.
TEST_F(HearControllerTest, AHostThatFailedIsInTheRecordingAndEveryReplayOnce) {
  says(KB_DONE, KB_OK, 2.0);
  run.dialog_failure = kGaveUp;
  run.dialog_failed_s = 2.1;
  hear(run);
  EXPECT_THAT(run.problems, ElementsAre(kGaveUp));
  EXPECT_THAT(run.recording.problems, ElementsAre(kGaveUp));
  EXPECT_THAT(replayed().problems, ElementsAre(kGaveUp));
  EXPECT_THAT(replayed().recording.problems, ElementsAre(kGaveUp));
}

TEST_F(HearControllerTest, AStopThatIsNotTheReleasesIsToldOnce) {
  says(KB_STOPPED, KB_FAULT_SILENT, 2.0);
  hear(run);
  ASSERT_EQ(run.recording.problems.size(), 1U);
  EXPECT_EQ(run.problems, run.recording.problems);
  EXPECT_EQ(replayed().problems, run.problems);
}

TEST_F(HearControllerTest, AReleaseThatStoppedIsNoProblem) {
  says(KB_STOPPED, KB_FAULT_DRY, 2.0);
  run.dialog_failure = "at 2.000 s: the controller stopped";
  run.dialog_failed_s = 2.0;
  EXPECT_THAT(unprovenDialog(the_case, run.recording, run), IsEmpty());
  hear(run);
  EXPECT_THAT(run.problems, IsEmpty());
  EXPECT_THAT(run.recording.problems, IsEmpty());
}

TEST_F(HearControllerTest, AnotherDialogThatFailedIsAProblemOfBoth) {
  the_case.scenario.firmware.dialog = FirmwareChoice::Dialog::kLineOk;
  run.dialog_failure = "at 2.100 s: error:9";
  EXPECT_EQ(unprovenDialog(the_case, run.recording, run), run.dialog_failure);
  hear(run);
  EXPECT_THAT(run.problems, ElementsAre(run.dialog_failure));
  EXPECT_THAT(run.recording.problems, ElementsAre(run.dialog_failure));
}

}  // namespace
}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/controller_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "firmware_under_test/controller/protocol.h"
#include "tests/hil/controller/spoken_frames.h"

namespace kerfbench::judge {
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
    run.recording.uart.push_back({kRate.ticksAt(at_s), controller::spokenState(state, fault, 0)});
  }
  void hear(run::RecordedRun& heard) {
    Conclusion conclusion;
    collectControllerEvidence(test_case, run::PreparedJob{}, run.recording,
                              std::numeric_limits<double>::quiet_NaN(), heard, conclusion);
  }
  /// Run that is made of the recording without a dialog.
  run::RecordedRun replayed() {
    run::RecordedRun replay;
    replay.problems = replay.recording.problems = run.recording.problems;
    hear(replay);
    return replay;
  }
  scenario::Case test_case;
  run::RecordedRun run;
};

// An earlier replay did not contain the failure, and passed.
TEST_F(HearControllerTest, AHostThatFailedIsInTheRecordingAndEveryReplayOnce) {
  says(KB_DONE, KB_OK, 2.0);
  run.dialog.reason = kGaveUp;
  run.dialog.time_s = 2.1;
  hear(run);
  EXPECT_THAT(run.problems, ElementsAre(kGaveUp));
  EXPECT_THAT(run.recording.problems, ElementsAre(kGaveUp));
  EXPECT_THAT(replayed().problems, ElementsAre(kGaveUp));
  EXPECT_THAT(replayed().recording.problems, ElementsAre(kGaveUp));
}

// The end and the account stand in other reports, which is no reason to believe a recording that lacks words.
TEST_F(HearControllerTest, AWordThatIsMissingIsAProblemOfAnEmulatedLine) {
  says(KB_RUNNING, KB_OK, 1.0);
  says(KB_DONE, KB_OK, 2.0);
  run.recording.uart.front().bytes.erase(run.recording.uart.front().bytes.begin() + 9);
  hear(run);
  EXPECT_THAT(run.problems, ElementsAre(testing::HasSubstr("belong to no whole report")));
  run.problems.clear();
  test_case.scenario.firmware.source = scenario::FirmwareChoice::Source::kGpio;
  hear(run);
  EXPECT_THAT(run.problems, IsEmpty()) << "a real line may lose one";
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
  run.dialog.reason = "at 2.000 s: the controller stopped";
  run.dialog.time_s = 2.0;
  EXPECT_THAT(unprovenDialog(test_case, run.recording, run), IsEmpty());
  hear(run);
  EXPECT_THAT(run.problems, IsEmpty());
  EXPECT_THAT(run.recording.problems, IsEmpty());
}

TEST_F(HearControllerTest, AnotherDialogThatFailedIsAProblemOfBoth) {
  test_case.scenario.firmware.dialog = scenario::FirmwareChoice::Dialog::kLineOk;
  run.dialog.reason = "at 2.100 s: error:9";
  EXPECT_EQ(unprovenDialog(test_case, run.recording, run), run.dialog.reason);
  hear(run);
  EXPECT_THAT(run.problems, ElementsAre(run.dialog.reason));
  EXPECT_THAT(run.recording.problems, ElementsAre(run.dialog.reason));
}

}  // namespace
}  // namespace kerfbench::judge

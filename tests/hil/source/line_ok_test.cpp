// SPDX-License-Identifier: Apache-2.0
#include "hil/source/line_ok.h"

#include <gmock/gmock.h>

#include "tests/hil/source/avr_run.h"

namespace kerfbench::source {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using State = LineOkSender::State;

std::string say(LineOkSender& sender, std::string_view heard, double now_s) {
  const auto out = sender.step({reinterpret_cast<const std::uint8_t*>(heard.data()), heard.size()}, now_s);
  return {out.begin(), out.end()};
}

TEST(LineOk, SendsOneLineForEachOkWithoutCommentsAndBlanks) {
  LineOkSender sender("%\nG21 ; mm\n\n(outline)\n G1 X1 (here) Y2\r\nM5");
  EXPECT_EQ(say(sender, "", 0), "");
  EXPECT_EQ(say(sender, "\r\nGrbl 1.1h ['$' for help]\r\n", 0.1), "G21\n");
  EXPECT_EQ(say(sender, "o", 0.2), "");
  EXPECT_EQ(say(sender, "k\r\n", 0.3), "G1 X1  Y2\n");
  EXPECT_DOUBLE_EQ(sender.progress(), 1.0 / 3);
  EXPECT_EQ(say(sender, "[MSG:hi]\r\n<Run|MPos:0>\r\nok\r\n", 0.4), "M5\n");
  EXPECT_EQ(say(sender, "ok\r\n", 0.5), "?");
  EXPECT_EQ(sender.state(), State::kDraining);
  EXPECT_EQ(say(sender, "<Run|MPos:0>\r\n", 0.55), "");
  EXPECT_EQ(say(sender, "", 0.61), "?");
  EXPECT_EQ(say(sender, "<Idle|MPos:0>\r\n", 0.7), "");
  EXPECT_EQ(sender.state(), State::kDone);
  EXPECT_DOUBLE_EQ(sender.progress(), 1.0);
}

TEST(LineOk, FirmwareWithoutABannerIsAskedByAnEmptyLine) {
  LineOkSender sender("M5\n", {.wait_for_idle = false});
  EXPECT_EQ(say(sender, "", 0), "");
  EXPECT_EQ(say(sender, "", 1.6), "\n");
  EXPECT_EQ(say(sender, "", 1.7), "");
  EXPECT_EQ(say(sender, "ok\n", 1.8), "M5\n");
  say(sender, "ok\n", 1.9);
  EXPECT_EQ(sender.state(), State::kDone);
}

TEST(LineOk, LateBannerAndTheEmptyLinesOkAreNotTakenForAnAnswer) {
  LineOkSender sender("M3\nM5\n");
  say(sender, "", 0);
  EXPECT_EQ(say(sender, "", 2), "\n");
  EXPECT_EQ(say(sender, "Grbl 1.1h\n", 2.1), "");
  EXPECT_EQ(say(sender, "ok\n", 2.15), "M3\n");
  EXPECT_DOUBLE_EQ(sender.progress(), 0.0);
}

TEST(LineOk, LateBannerOfAFirmwareThatMissedTheEmptyLineStartsTheProgram) {
  LineOkSender sender("M3\n");
  say(sender, "", 0);
  say(sender, "", 2);
  EXPECT_EQ(say(sender, "Grbl 1.1h\n", 2.1), "");
  EXPECT_EQ(say(sender, "", 2.25), "M3\n");
}

TEST(LineOk, ErrorsAndAlarmsNameTheLine) {
  for (const auto* word : {"error:20", "ALARM:1"}) {
    LineOkSender sender("M3\n\nG99 X1\nM5\n");
    say(sender, "hello\n", 0);
    say(sender, "ok\n", 0.1);
    EXPECT_EQ(say(sender, std::string(word) + "\r\n", 0.2), "");
    EXPECT_EQ(sender.state(), State::kFailed);
    EXPECT_THAT(sender.message(), AllOf(HasSubstr(word), HasSubstr("line 3"), HasSubstr("G99 X1")));
    EXPECT_EQ(say(sender, "ok\n", 0.3), "");
  }
}

TEST(LineOk, SilenceFails) {
  LineOkSender mute("M3\n");
  say(mute, "", 10);
  say(mute, "", 12);
  say(mute, "", 13.1);
  EXPECT_EQ(mute.state(), State::kFailed);

  LineOkSender stuck("M3\n", {.reply_timeout_s = 5});
  say(stuck, "hello\n", 0);
  say(stuck, "", 4.9);
  EXPECT_EQ(stuck.state(), State::kStreaming);
  say(stuck, "", 5.1);
  EXPECT_EQ(stuck.state(), State::kFailed);
  EXPECT_THAT(stuck.message(), HasSubstr("line 1"));
}

TEST(LineOk, EndlessLineFails) {
  LineOkSender sender("M3\n");
  say(sender, std::string(5000, 'U'), 0);
  EXPECT_EQ(sender.state(), State::kFailed);
}

TEST(LineOk, FirmwareThatMakesNoReportsIsDoneAfterItsLastOk) {
  LineOkSender sender("M5\n");
  say(sender, "hello\n", 0);
  EXPECT_EQ(say(sender, "ok\n", 1), "?");
  say(sender, "", 2.1);
  EXPECT_EQ(sender.state(), State::kDone);
}

class LineOkAvr : public ::testing::Test {
 protected:
  void run(const std::string& program) {
    auto options = avrOptions("line_ok");
    options.baud = 115'200;
    const auto source = openChild(options);
    LineOkSender sender(program);
    Batch batch;
    for (Tick tick = kMs / 2; tick < 3000 * kMs; tick += kMs / 2) {
      ASSERT_EQ(source->advance(tick, batch), Stop::kReached) << source->message();
      const auto rises = edgesOf(batch.events, kPA0);
      pulses_.insert(pulses_.end(), rises.begin(), rises.end());
      const auto out = sender.step(batch.uart, source->info().rate.seconds(tick));
      if (!out.empty()) source->uartWrite(out);
      if (sender.state() == State::kDone || sender.state() == State::kFailed) break;
    }
    state_ = sender.state();
    message_ = sender.message();
  }
  State state_{};
  std::string message_;
  std::vector<Tick> pulses_;
};

TEST_F(LineOkAvr, ProgramMakesItsPulses) {
  run("; a program\nX100\nX250\nX50 (last)\n");
  EXPECT_EQ(state_, State::kDone) << message_;
  EXPECT_EQ(pulses_.size(), 400U);
}

TEST_F(LineOkAvr, ErrorStopsIt) {
  run("X100\nE\nX50\n");
  EXPECT_EQ(state_, State::kFailed);
  EXPECT_THAT(message_, AllOf(HasSubstr("error:20"), HasSubstr("line 2")));
  EXPECT_GT(pulses_.size(), 0U);
}

}  // namespace
}  // namespace kerfbench::source

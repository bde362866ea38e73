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

/// Lets a firmware greet at 0 s and falls silent, until the first lines are sent at 0.3 s.
std::string connect(LineOkSender& sender, std::string_view greeting = "hello\n") {
  EXPECT_EQ(say(sender, greeting, 0.0), "");
  return say(sender, "", 0.3);
}

TEST(LineOk, SendsOneLineForEachOkWithoutCommentsAndBlanks) {
  LineOkSender sender("%\nG21 ; mm\n\n(outline)\n G1 X1 (here) Y2\r\nM5");
  EXPECT_EQ(say(sender, "", 0), "");
  EXPECT_EQ(say(sender, "\r\nGrbl 1.1h ['$' for help]\r\n", 0.1), "");
  EXPECT_EQ(say(sender, "", 0.4), "G21\n");
  EXPECT_EQ(say(sender, "o", 0.5), "");
  EXPECT_EQ(say(sender, "k\r\n", 0.6), "G1 X1  Y2\n");
  EXPECT_DOUBLE_EQ(sender.progress(), 1.0 / 3);
  EXPECT_EQ(say(sender, "[MSG:hi]\r\n<Run|MPos:0>\r\nok\r\n", 0.7), "M5\n");
  EXPECT_EQ(say(sender, "ok\r\n", 0.8), "?");
  EXPECT_EQ(sender.state(), State::kDraining);
  EXPECT_EQ(say(sender, "<Run|MPos:0>\r\n", 0.85), "");
  EXPECT_EQ(say(sender, "", 0.91), "?");
  EXPECT_EQ(say(sender, "<Idle|MPos:0>\r\n", 1.0), "");
  EXPECT_EQ(sender.state(), State::kDone);
  EXPECT_FALSE(sender.mayStillMove());
  EXPECT_DOUBLE_EQ(sender.progress(), 1.0);
}

TEST(LineOk, NothingIsSentBeforeTheFirmwareHasBeenQuiet) {
  LineOkSender sender("M3\n");
  EXPECT_EQ(say(sender, "Grbl 1.1h\n", 0.0), "");
  EXPECT_EQ(say(sender, "[MSG:", 0.25), "");
  EXPECT_EQ(say(sender, "hi]\n", 0.5), "");
  EXPECT_EQ(say(sender, "", 0.79), "");
  EXPECT_EQ(say(sender, "", 0.8), "M3\n");
}

TEST(LineOk, FirmwareThatNeverStopsTalkingIsSpokenToAllTheSame) {
  LineOkSender sender("M3\n", {.connect_timeout_s = 2.0});
  std::string sent;
  double now_s = 0.0;
  for (; sent.empty() && now_s < 10.0; now_s += 0.1) sent = say(sender, "T:20\n", now_s);
  EXPECT_EQ(sent, "M3\n");
  EXPECT_NEAR(now_s, 2.1, 0.15);
}

TEST(LineOk, ComplaintsOfTheStartAreKeptAndForgiven) {
  LineOkSender sender("M3\n");
  EXPECT_EQ(connect(sender, "error:7\r\n$0=10\r\n\r\nGrbl 1.1h ['$' for help]\r\nALARM:3\r\n"), "M3\n");
  EXPECT_EQ(sender.state(), State::kStreaming);
  EXPECT_THAT(sender.complaintsAtStart(), testing::ElementsAre("error:7", "ALARM:3"));
}

TEST(LineOk, FirmwareThatGreetsAgainHasStartedAgain) {
  for (const bool drains : {false, true}) {
    LineOkSender sender("M3\nM5\n");
    connect(sender, "Grbl 1.1h\n");
    if (drains) say(sender, "ok\nok\n", 0.4);
    ASSERT_EQ(sender.state(), drains ? State::kDraining : State::kStreaming);
    say(sender, "Grbl 1.1h\n", 0.5);
    EXPECT_EQ(sender.state(), State::kFailed);
    EXPECT_THAT(sender.message(), AllOf(HasSubstr("started again"), HasSubstr("Grbl 1.1h")));
    if (!drains) EXPECT_THAT(sender.message(), HasSubstr("line 1: M3"));
  }
}

TEST(LineOk, WhatAFirmwareSaidAtLengthWhileItStartedIsNoGreeting) {
  LineOkSender sender("M3\nM5\n");
  connect(sender, "T:20\n[MSG:hi]\nT:20\n");
  EXPECT_EQ(say(sender, "T:20\n[MSG:hi]\nok\n", 0.4), "M5\n");
}

TEST(LineOk, FirmwareWithoutABannerIsAskedByAnEmptyLine) {
  LineOkSender sender("M5\n", {.wait_for_idle = false});
  EXPECT_EQ(say(sender, "", 0), "");
  EXPECT_EQ(say(sender, "", 1.6), "\n");
  EXPECT_EQ(say(sender, "", 1.7), "");
  EXPECT_EQ(say(sender, "ok\n", 1.8), "");
  EXPECT_EQ(say(sender, "", 2.1), "M5\n");
  say(sender, "ok\n", 2.2);
  EXPECT_EQ(sender.state(), State::kDone);
  EXPECT_TRUE(sender.mayStillMove());
}

TEST(LineOk, LateBannerAndTheEmptyLinesOkAreNotTakenForAnAnswer) {
  LineOkSender sender("M3\nM5\n");
  say(sender, "", 0);
  EXPECT_EQ(say(sender, "", 2), "\n");
  EXPECT_EQ(say(sender, "Grbl 1.1h\n", 2.1), "");
  EXPECT_EQ(say(sender, "ok\n", 2.15), "");
  EXPECT_EQ(say(sender, "", 2.45), "M3\n");
  EXPECT_DOUBLE_EQ(sender.progress(), 0.0);
}

TEST(LineOk, SetupLinesGoFirstOneByOneAndErrorsNameThem) {
  LineOkSender sender("M3\nM5\n", {.setup = {"$100=250", "; nothing", "$32=1"}, .ahead_bytes = 127});
  EXPECT_EQ(connect(sender), "$100=250\n");
  EXPECT_EQ(say(sender, "ok\n", 0.4), "$32=1\n");
  say(sender, "error:3\n", 0.5);
  EXPECT_EQ(sender.state(), State::kFailed);
  EXPECT_THAT(sender.message(),
              AllOf(HasSubstr("error:3"), HasSubstr("line 3 of the setup"), HasSubstr("$32=1")));
}

TEST(LineOk, LinesAheadFillTheFirmwaresBufferAndNoMore) {
  LineOkSender sender("G1 X1\nG1 X2\nG1 X3\nG1 X4\n", {.setup = {"$32=1"}, .ahead_bytes = 17});
  EXPECT_EQ(connect(sender), "$32=1\n");
  EXPECT_EQ(say(sender, "ok\n", 0.4), "G1 X1\nG1 X2\n");
  EXPECT_EQ(say(sender, "", 0.5), "");
  EXPECT_EQ(say(sender, "ok\n", 0.6), "G1 X3\n");
  EXPECT_EQ(say(sender, "ok\nok\n", 0.7), "G1 X4\n");
  say(sender, "error:20\n", 0.8);
  EXPECT_THAT(sender.message(), AllOf(HasSubstr("line 4"), HasSubstr("G1 X4")));
}

TEST(LineOk, ALineLongerThanTheBufferGoesAlone) {
  LineOkSender sender("M3\nG1 X100.000 Y100.000\n", {.ahead_bytes = 10});
  EXPECT_EQ(connect(sender), "M3\n");
  EXPECT_EQ(say(sender, "ok\n", 0.4), "G1 X100.000 Y100.000\n");
}

TEST(LineOk, AnswersThatNobodyAskedForMoveNothingOn) {
  LineOkSender sender("M3\nM5\n");
  connect(sender);
  EXPECT_EQ(say(sender, "ok\n", 0.4), "M5\n");
  say(sender, "ok\nok\nok\n", 0.5);
  EXPECT_EQ(sender.state(), State::kDraining);
  EXPECT_DOUBLE_EQ(sender.progress(), 1.0);
}

TEST(LineOk, ErrorsAndAlarmsNameTheLine) {
  for (const auto* word : {"error:20", "ALARM:1"}) {
    LineOkSender sender("M3\n\nG99 X1\nM5\n");
    connect(sender);
    say(sender, "ok\n", 0.4);
    EXPECT_EQ(say(sender, std::string(word) + "\r\n", 0.5), "");
    EXPECT_EQ(sender.state(), State::kFailed);
    EXPECT_THAT(sender.message(), AllOf(HasSubstr(word), HasSubstr("line 3"), HasSubstr("G99 X1")));
    EXPECT_EQ(say(sender, "ok\n", 0.6), "");
  }
}

TEST(LineOk, SilenceFails) {
  LineOkSender mute("M3\n");
  say(mute, "", 10);
  say(mute, "", 12);
  say(mute, "", 13.1);
  EXPECT_EQ(mute.state(), State::kFailed);

  LineOkSender stuck("M3\n", {.reply_timeout_s = 5});
  connect(stuck);
  say(stuck, "", 5.2);
  EXPECT_EQ(stuck.state(), State::kStreaming);
  say(stuck, "", 5.4);
  EXPECT_EQ(stuck.state(), State::kFailed);
  EXPECT_THAT(stuck.message(), HasSubstr("line 1"));

  LineOkSender patient("M3\n", {.reply_timeout_s = 5});
  connect(patient);
  say(patient, "echo:busy: processing\n", 5.0);
  say(patient, "", 9.9);
  EXPECT_EQ(patient.state(), State::kStreaming);
}

TEST(LineOk, EndlessLineFails) {
  LineOkSender sender("M3\n");
  say(sender, std::string(5000, 'U'), 0);
  EXPECT_EQ(sender.state(), State::kFailed);
}

TEST(LineOk, FirmwareThatMakesNoReportsIsDoneAfterItsLastOk) {
  LineOkSender sender("M5\n");
  connect(sender);
  EXPECT_EQ(say(sender, "ok\n", 1), "?");
  say(sender, "", 2.1);
  EXPECT_EQ(sender.state(), State::kDone);
  EXPECT_TRUE(sender.mayStillMove());
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

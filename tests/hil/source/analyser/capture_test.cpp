// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "tests/hil/source/analyser/scripted_analyser.h"

namespace kerfbench::source {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kRate = 1'000'000;

class AnalyserCaptureTest : public testing::Test {
 protected:
  AnalyserCaptureTest() {
    map.assign(Signal::kGalvoXPul, {0, 3});
    map.assign(Signal::kGalvoXDir, {0, 5});
    map.assign(Signal::kLaserGate, {1, 0});
    map.assign(Signal::kEncoderA, {2, 0});
    options.request.driver = "demo";
    options.request.samplerate_hz = kRate;
    options.request.channels = {"D0", "D1", "D2"};
    options.signals = {Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kLaserGate};
    options.quiet_s = 0.5;
    options.time_limit_s = 3.0;
  }
  PinCapture capture() { return captureAnalyser(options, map, analyser); }
  /// Expects a problem, which leaves a mark that a replay finds.
  void expectInvalid(const std::string& words) {
    const PinCapture captured = capture();
    EXPECT_THAT(captured.recording.problems, Contains(HasSubstr(words)));
    ASSERT_FALSE(captured.recording.outputs.empty());
    EXPECT_EQ(captured.recording.outputs.back().flags, PinEvent::kGap);
    EXPECT_EQ(captured.recording.outputs.back().tick, captured.recording.end);
    EXPECT_TRUE(std::ranges::is_sorted(captured.recording.outputs, {}, &PinEvent::tick));
  }
  SignalMap map;
  AnalyserCaptureOptions options;
  ScriptedAnalyser analyser;
};

TEST_F(AnalyserCaptureTest, EdgesHaveTheTickOfTheirFirstSampleAfterALead) {
  // Line DIR rests high; one pulse of 5 samples with the gate open.
  analyser.runs = {{700'000, 0b010}, {5, 0b111}, {1, 0b110}, {1'000'000, 0b010}};
  const PinCapture captured = capture();
  EXPECT_THAT(captured.recording.problems, IsEmpty());
  EXPECT_EQ(captured.edges, 4U);
  EXPECT_EQ(captured.recording.rate, (TickRate{1, kRate}));
  EXPECT_EQ(captured.recording.stamp_err_ticks, 1U);
  EXPECT_THAT(captured.recording.outputs,
              ElementsAre(PinEvent{1, 0, 0x20, 0x20, 0}, PinEvent{100'000, 0, 0x08, 0x28, 0},
                          PinEvent{100'000, 1, 1, 1, 0}, PinEvent{100'005, 0, 0x08, 0x20, 0},
                          PinEvent{100'006, 1, 1, 0, 0}));
  EXPECT_EQ(captured.recording.end, 300'006U);
  EXPECT_EQ(analyser.requested.listen.quiet_samples, 500'000U);
  EXPECT_EQ(analyser.requested.listen.limit_samples, 3'000'000U);
}

TEST_F(AnalyserCaptureTest, AnEdgeAtTheVeryStartIsLaterThanTheLevelsAtTheStart) {
  analyser.runs = {{1, 0b010}, {600'000, 0b011}};
  EXPECT_THAT(capture().recording.outputs,
              ElementsAre(PinEvent{1, 0, 0x20, 0x20, 0}, PinEvent{2, 0, 0x08, 0x28, 0}));
}

// Packets cut the runs anywhere: the recording does not depend on it.
TEST_F(AnalyserCaptureTest, TheSizeOfPacketsMakesNoDifference) {
  analyser.runs = {{700'000, 0}, {5, 1}, {1'000'000, 0}};
  const PinCapture whole = capture();
  analyser.runs = {{1, 0}, {699'999, 0}, {2, 1}, {3, 1}, {499'999, 0}, {1, 0}, {77, 1}};
  const PinCapture pieces = capture();
  EXPECT_EQ(pieces.recording.outputs, whole.recording.outputs);
  EXPECT_EQ(pieces.recording.end, whole.recording.end);
  EXPECT_THAT(pieces.recording.problems, IsEmpty());
}

TEST_F(AnalyserCaptureTest, WrittenAndReadAgainItIsTheSame) {
  analyser.runs = {{700'000, 0b010}, {5, 0b111}, {1, 0b110}};
  const PinCapture captured = capture();  // The device stops.
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("analyser_" + std::to_string(::getpid()) + ".vcd");
  writeVcd(path, captured.recording, map);
  const PinRecording again = readVcd(path, map);
  std::filesystem::remove(path);
  EXPECT_EQ(again.outputs, captured.recording.outputs);
  EXPECT_EQ(again.end, captured.recording.end);
  EXPECT_EQ(again.stamp_err_ticks, 1U);
  EXPECT_EQ(again.problems, captured.recording.problems);
}

TEST_F(AnalyserCaptureTest, ADeviceThatStopsByItselfIsAProblem) {
  analyser.runs = {{700'000, 0}, {5, 1}, {100, 0}};
  expectInvalid("the analyser stopped by itself after 700105 samples, 0.700105 s at 1000000 Hz");
}

TEST_F(AnalyserCaptureTest, PinsThatStayQuietAreNoEvidence) {
  analyser.runs = {{10'000'000, 0}};
  expectInvalid("no edge came within 3 s");
}

TEST_F(AnalyserCaptureTest, NoSampleAtAllIsNoEvidence) { expectInvalid("stopped by itself after 0 samples"); }

TEST_F(AnalyserCaptureTest, PinsThatNeverComeToRestReachTheTimeLimit) {
  for (std::uint32_t i = 0; i < 40; ++i) analyser.runs.push_back({100'000, i % 2});
  expectInvalid("the pins were not quiet");
}

TEST_F(AnalyserCaptureTest, WhatTheDriverSaysIsAProblemAndItsWarningsAreNotes) {
  analyser.runs = {{700'000, 0}, {5, 1}, {1'000'000, 0}};
  analyser.problems = {"the analyser's driver says: overflow"};
  analyser.notes = {"warm"};
  expectInvalid("overflow");
  EXPECT_THAT(capture().notes, ElementsAre("warm"));
}

TEST_F(AnalyserCaptureTest, APulThatRestsHighWhereItsDriveCountsRisingEdgesIsAProblem) {
  options.at_start.low = {Signal::kGalvoXPul};
  analyser.runs = {{700'000, 0b001}, {5, 0}, {1'000'000, 0b001}};
  expectInvalid("galvo_x_pul is high at the start");
  analyser.runs = {{700'000, 0b010}, {5, 0}, {1'000'000, 0b010}};
  EXPECT_THAT(capture().recording.problems, IsEmpty());
}

TEST_F(AnalyserCaptureTest, AnAnalyserThatCannotBeHadIsAnError) {
  analyser.refusal = "nothing there";
  EXPECT_THROW(capture(), AnalyserError);
}

TEST_F(AnalyserCaptureTest, WishesThatMakeNoSenseAreMistakesOfOurs) {
  const AnalyserCaptureOptions good = options;
  const auto refused = [&](auto change) {
    options = good;
    change(options);
    EXPECT_THROW(capture(), std::invalid_argument);
  };
  refused([](auto& o) { o.signals[0] = Signal::kEncoderA; });
  refused([](auto& o) { o.signals[0] = Signal::kFeedPul; });
  refused([](auto& o) { o.signals.pop_back(); });
  refused([](auto& o) { o.request.samplerate_hz = 0; });
  refused([](auto& o) { o.quiet_s = 0.0; });
  refused([](auto& o) { o.time_limit_s = 1e12; });
}

}  // namespace
}  // namespace kerfbench::source

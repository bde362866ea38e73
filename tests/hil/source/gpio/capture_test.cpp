// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "hil/source/open.h"
#include "tests/hil/source/gpio/scripted_kernel.h"

namespace kerfbench::source {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kStart = ScriptedKernel::kStart_ns;
constexpr PinId kPul{0, 3};
constexpr PinId kDir{0, 5};
constexpr PinId kGate{1, 0};

class CaptureTest : public testing::Test {
 protected:
  CaptureTest() {
    map.assign(Signal::kGalvoXPul, kPul);
    map.assign(Signal::kGalvoXDir, kDir);
    map.assign(Signal::kLaserGate, kGate);
    map.assign(Signal::kEncoderA, {2, 0});
    options.chip = "/dev/gpiochip0";
    options.wires = {{Signal::kGalvoXPul, 0}, {Signal::kGalvoXDir, 1}, {Signal::kLaserGate, 2}};
    options.stamp_err_s = 20e-6;
    options.quiet_s = 0.5;
    options.time_limit_s = 3.0;
  }
  /// Makes 100 pulses at 10 kHz with a turn after 50, from 1 s after the start; the gate is open meanwhile.
  void job() {
    std::uint64_t now = kStart + 1'000'000'000;
    kernel->toggle(now, 2);
    for (int i = 0; i < 100; ++i) {
      if (i == 50) kernel->toggle(now += 30'000, 1);
      kernel->toggle(now += 50'000, 0);
      kernel->toggle(now += 50'000, 0);
    }
    kernel->toggle(now += 50'000, 2);
    kernel->level_bits = 0;
    levels_in_the_end = 0b010;
    // The levels at the start are read before the first wait.
    kernel->before_poll = [this](std::uint64_t) { kernel->level_bits = levels_in_the_end; };
  }
  PinCapture capture() { return capturePins(options, map, kernel); }
  static bool hasGap(const PinCapture& captured) {
    return std::ranges::any_of(captured.recording.outputs, [](const PinEvent& e) { return e.flags != 0; });
  }
  /// Expects a problem, which leaves a mark that a replay finds.
  void expectInvalid(const PinCapture& captured, const std::string& words) {
    EXPECT_THAT(captured.recording.problems, testing::Contains(HasSubstr(words)));
    EXPECT_TRUE(hasGap(captured)) << words;
    EXPECT_TRUE(std::ranges::is_sorted(captured.recording.outputs, {}, &PinEvent::tick));
  }
  SignalMap map;
  GpioCaptureOptions options;
  std::uint64_t levels_in_the_end{};
  const std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
};

TEST_F(CaptureTest, AJobIsRecordedEdgeByEdge) {
  job();
  const PinCapture captured = capture();
  EXPECT_THAT(captured.recording.problems, IsEmpty());
  EXPECT_FALSE(hasGap(captured));
  EXPECT_EQ(captured.edges, 203U);
  const PinRecording& recording = captured.recording;
  EXPECT_EQ(recording.rate, (TickRate{1, 1'000'000'000}));
  EXPECT_EQ(recording.stamp_err_ticks, 20'000U);
  ASSERT_EQ(recording.outputs.size(), 203U);
  // The recording begins a tenth of a second before the first edge and ends a fifth after the last.
  EXPECT_EQ(recording.outputs.front(), (PinEvent{100'000'000, 1, 1, 1, 0}));
  EXPECT_EQ(recording.end, recording.outputs.back().tick + 200'000'000);
  std::size_t pulses = 0;
  for (const PinEvent& event : recording.outputs)
    pulses += event.changed == 1U << 3U && (event.level & 8U) != 0 ? 1 : 0;
  EXPECT_EQ(pulses, 100U);
  const std::vector<PinEvent> events = recording.outputs.unpacked();
  EXPECT_EQ(events[202].port, 1);
  EXPECT_EQ(events[202].level, 0);
  EXPECT_EQ(events[201].level, 1U << 5U);
  EXPECT_THAT(kernel->open_fds, IsEmpty());
}

// The live run and its replay are one evidence.
TEST_F(CaptureTest, WrittenAndReadAgainItIsTheSame) {
  job();
  const PinCapture captured = capture();
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("capture_" + std::to_string(::getpid()) + ".vcd");
  writeVcd(path, captured.recording, map);
  const PinRecording again = readVcd(path, map);
  EXPECT_EQ(openVcd(path, map)->info().stamp_err_ticks, 20'000U);
  std::filesystem::remove(path);
  EXPECT_EQ(again.outputs, captured.recording.outputs);
  EXPECT_EQ(again.end, captured.recording.end);
  EXPECT_EQ(again.rate, captured.recording.rate);
  EXPECT_EQ(again.stamp_err_ticks, captured.recording.stamp_err_ticks);
}

TEST_F(CaptureTest, EdgesOfOnePortAtOneStampAreOneEvent) {
  kernel->toggle(kStart + 1'000'000'000, 0);
  kernel->toggle(kStart + 1'000'000'000, 1);
  kernel->toggle(kStart + 1'000'000'000, 2);
  kernel->before_poll = [this](std::uint64_t) { kernel->level_bits = 0b111; };
  EXPECT_THAT(capture().recording.outputs,
              ElementsAre(PinEvent{100'000'000, 0, 0x28, 0x28, 0}, PinEvent{100'000'000, 1, 1, 1, 0}));
}

TEST_F(CaptureTest, LinesThatAreHighAtTheStartAreSoInTheRecording) {
  kernel->level_bits = 0b011;
  kernel->edge(kStart + 1'000'000, 0, false, 1, 1, kStart + 1'000'000);
  kernel->before_poll = [this](std::uint64_t) { kernel->level_bits = 0b010; };
  const PinCapture captured = capture();
  EXPECT_THAT(captured.recording.problems, IsEmpty());
  EXPECT_THAT(captured.recording.outputs,
              ElementsAre(PinEvent{1, 0, 0x28, 0x28, 0}, PinEvent{1'000'001, 0, 0x08, 0x20, 0}));
}

TEST_F(CaptureTest, APulThatRestsHighWhereItsDriveCountsRisingEdgesIsAProblem) {
  job();
  options.at_start.low = {Signal::kGalvoXPul};
  kernel->level_bits = 0b010;
  EXPECT_THAT(capture().recording.problems, testing::Not(testing::Contains(HasSubstr("high at the start"))));
  const auto other = std::make_shared<ScriptedKernel>();
  other->level_bits = 0b001;
  expectInvalid(capturePins(options, map, other), "galvo_x_pul is high at the start");
}

TEST_F(CaptureTest, AGateThatOpensTheLaserWhileLowMustRestHigh) {
  job();
  options.at_start.high = {Signal::kLaserGate};
  expectInvalid(capture(), "laser_gate is low at the start, and the laser may emit while it is low");
  const auto other = std::make_shared<ScriptedKernel>();
  other->level_bits = 0b100;
  EXPECT_THAT(capturePins(options, map, other).recording.problems,
              testing::Not(testing::Contains(HasSubstr("laser_gate"))));
}

TEST_F(CaptureTest, PinsThatStayQuietAreNoEvidence) {
  const PinCapture captured = capture();
  expectInvalid(captured, "no edge came within 3 s");
  EXPECT_EQ(captured.edges, 0U);
}

TEST_F(CaptureTest, PinsThatNeverComeToRestReachTheTimeLimit) {
  for (std::uint64_t i = 1; i < 400; ++i) kernel->toggle(kStart + i * 10'000'000, 0);
  expectInvalid(capture(), "the pins were not quiet");
}

// Merged edges at the very end leave no gap, because no number follows.
TEST_F(CaptureTest, TheLevelsInTheEndAreASecondWitness) {
  job();
  levels_in_the_end = 0b011;
  expectInvalid(capture(), "galvo_x_pul is high in the end, and its edges say low");
}

TEST_F(CaptureTest, ALostEdgeMakesTheCaptureInvalid) {
  kernel->edge(kStart + 1'000'000'000, 0, true, 1, 1, kStart + 1'000'000'000);
  kernel->edge(kStart + 1'000'300'000, 0, true, 3, 2, kStart + 1'000'300'000);
  kernel->before_poll = [this](std::uint64_t) { kernel->level_bits = 0b001; };
  const PinCapture captured = capture();
  expectInvalid(captured, "1 edge lost in the kernel before they were read");
  expectInvalid(captured, "the first trouble with edges is 1.000300 s after the start");
}

TEST_F(CaptureTest, AChipThatVanishesEndsTheCaptureAndWhatCameIsKept) {
  job();
  kernel->before_poll = [this](std::uint64_t now) {
    if (now > kStart + 1'005'000'000) kernel->poll_revents = POLLERR | POLLHUP;
  };
  const PinCapture captured = capture();
  expectInvalid(captured, "the chip has gone while its lines were read");
  EXPECT_GT(captured.edges, 50U);
  EXPECT_LT(captured.edges, 203U);
}

TEST_F(CaptureTest, AChipThatVanishesBeforeTheLevelsAreReadInTheEndIsAProblem) {
  job();
  kernel->before_poll = [this](std::uint64_t) { kernel->levels_error = ENODEV; };
  expectInvalid(capture(), "the chip has gone");
}

// The kernel drops the oldest edges of a full buffer.
TEST_F(CaptureTest, AReaderThatStalledIsNoticedByTheNumbers) {
  std::uint32_t seqno = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    ++seqno;
    if (i >= 4000 - 2976) continue;
    kernel->edge(kStart + 500'000'000 + std::uint64_t{i} * 50'000, 0, i % 2 == 0, seqno, seqno,
                 kStart + 500'000'000 + std::uint64_t{i} * 50'000);
  }
  kernel->edge(kStart + 800'000'000, 0, true, 4001, 4001, kStart + 800'000'000);
  kernel->before_poll = [this](std::uint64_t) { kernel->level_bits = 0b001; };
  expectInvalid(capture(), "2976 edges lost because the kernel's buffer was full");
}

TEST_F(CaptureTest, WhatIsNotAllowedIsNotedAndNoProblem) {
  job();
  kernel->priority_error = EPERM;
  const PinCapture captured = capture();
  EXPECT_THAT(captured.notes, ElementsAre(HasSubstr("no real-time priority")));
  EXPECT_THAT(captured.recording.problems, IsEmpty());
}

TEST_F(CaptureTest, LinesThatCannotBeHadAreAnErrorAndLeaveNothingBehind) {
  kernel->taken = {{1, "someone"}};
  EXPECT_THROW(capture(), GpioError);
  EXPECT_THAT(kernel->open_fds, IsEmpty());
  EXPECT_EQ(kernel->real_time, 0);
}

TEST_F(CaptureTest, AWireForASensorOrAnUnknownSignalIsAMistakeOfOurs) {
  options.wires.push_back({Signal::kEncoderA, 3});
  EXPECT_THROW(capture(), std::invalid_argument);
  options.wires.back() = {Signal::kFeedPul, 3};
  EXPECT_THROW(capture(), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::source

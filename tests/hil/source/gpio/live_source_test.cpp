// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/live_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>

#include "tests/hil/source/gpio/scripted_kernel.h"
#include "tests/hil/source/serial/scripted_serial.h"

namespace kerfbench::source {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Origin of the ticks, which are ns since the first advance(); that is at tick 1.
constexpr std::uint64_t kOrigin = ScriptedKernel::kStart_ns - 1;
constexpr Tick kMs = 1'000'000;
constexpr PinId kEncoderA{3, 2};
constexpr PinId kEncoderB{3, 1};

class GpioLiveSourceTest : public testing::Test {
 protected:
  GpioLiveSourceTest() {
    map.assign(Signal::kGalvoXPul, {0, 3});
    map.assign(Signal::kGalvoXDir, {0, 5});
    map.assign(Signal::kEncoderA, kEncoderA);
    map.assign(Signal::kEncoderB, kEncoderB);
    map.assign(Signal::kInterlock, {11, 2});
    options.in.chip = "/dev/gpiochip0";
    options.in.wires = {{Signal::kGalvoXPul, 0}, {Signal::kGalvoXDir, 1}};
    options.in.stamp_err_s = 20e-6;
    options.in.quiet_s = 0.5;
    options.out_chip = "/dev/gpiochip0";
    options.out = {{Signal::kEncoderA, 8}, {Signal::kEncoderB, 9}, {Signal::kInterlock, 10}};
    options.high_at_start = {Signal::kInterlock};
  }
  GpioLiveSource& open(std::unique_ptr<SerialLine> uart = nullptr) {
    source = std::make_unique<GpioLiveSource>(options, map, kernel, std::move(uart));
    return *source;
  }
  std::unique_ptr<SerialLine> uart() { return std::make_unique<SerialLine>(serial, "/dev/ttyS9", 250'000); }
  /// Runs quantum by quantum, as a run does it; returns all events.
  std::vector<PinEvent> runTo(Tick end, Tick quantum = kMs) {
    std::vector<PinEvent> events;
    for (Tick until = batch.watermark + quantum; until <= end; until += quantum) {
      const Tick before = batch.watermark;
      stop = source->advance(until, batch);
      for (const PinEvent& event : batch.events) {
        EXPECT_GT(event.tick, before);
        EXPECT_LE(event.tick, batch.watermark);
      }
      events.insert(events.end(), batch.events.begin(), batch.events.end());
      if (stop != Stop::kReached) break;
    }
    return events;
  }
  void expectLost(const std::string& words) {
    runTo(100 * kMs);
    EXPECT_EQ(stop, Stop::kLost);
    EXPECT_THAT(source->message(), HasSubstr(words));
    // The source stays lost.
    EXPECT_EQ(source->advance(batch.watermark + kMs, batch), Stop::kLost);
    EXPECT_THAT(batch.events, IsEmpty());
  }
  SignalMap map;
  GpioLiveOptions options;
  std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
  const std::shared_ptr<ScriptedSerial> serial = std::make_shared<ScriptedSerial>();
  std::unique_ptr<GpioLiveSource> source;
  Batch batch;
  Stop stop{};
};

TEST_F(GpioLiveSourceTest, SensorsHaveTheirLevelsFromBeforeTheStart) {
  open();
  EXPECT_EQ(kernel->output_request.config.attrs[0].attr.values, 0b100U);
  runTo(2 * kMs);
  const GpioLiveRecord record = source->finish(2 * kMs);
  ASSERT_THAT(record.sensors, SizeIs(1));
  EXPECT_EQ(record.sensors[0].signal, Signal::kInterlock);
  EXPECT_EQ(record.sensors[0].tick, 1U);
  EXPECT_TRUE(record.sensors[0].level);
  EXPECT_EQ(record.lag.edges(), 0U);
}

TEST_F(GpioLiveSourceTest, EdgesThatArePlannedAheadArePutOutAtTheirTimes) {
  open();
  source->drive(kEncoderA, true, 3 * kMs + 17);
  source->drive(kEncoderB, true, 3 * kMs + 500);
  source->advance(kMs, batch);
  source->drive(kEncoderA, false, 40 * kMs);
  runTo(60 * kMs);
  ASSERT_THAT(kernel->driven, SizeIs(3));
  EXPECT_EQ(kernel->driven[0].at_ns, kOrigin + 3 * kMs + 17);
  EXPECT_EQ(kernel->driven[1].at_ns, kOrigin + 3 * kMs + 500);
  EXPECT_EQ(kernel->driven[2].at_ns, kOrigin + 40 * kMs);
  const GpioLiveRecord record = source->finish(60 * kMs);
  ASSERT_THAT(record.sensors, SizeIs(4));
  EXPECT_EQ(record.sensors[3].tick, 40 * kMs);
  EXPECT_FALSE(record.sensors[3].level);
  EXPECT_EQ(record.lag.edges(), 3U);
  EXPECT_EQ(record.lag.worst_ns(), 0);
}

TEST_F(GpioLiveSourceTest, WhatTheCallAndTheCallerTakeIsMeasuredAsLag) {
  kernel->set_takes_ns = 4'000;
  open();
  source->drive(kEncoderA, true, 30 * kMs);
  source->drive(kEncoderB, true, 60 * kMs);
  runTo(8 * kMs);             // The clock is at 29 ms.
  kernel->passTime(3 * kMs);  // The model computes over the first edge.
  runTo(50 * kMs);
  const GpioLiveRecord record = source->finish(100 * kMs);
  EXPECT_EQ(record.lag.worst_ns(), 2'004'000);
  EXPECT_EQ(record.lag.worstAt_ns(), 32 * kMs + 4'000);
  ASSERT_THAT(record.sensors, SizeIs(3));
  EXPECT_EQ(record.sensors[2].tick, 60 * kMs + 4'000);
}

TEST_F(GpioLiveSourceTest, ASensorThatAnswersToPinsIsLateByTheHoldBackAndIsMeasuredApart) {
  constexpr PinId kLimitX{5, 1};
  map.assign(Signal::kLimitX, kLimitX);
  options.out.push_back({Signal::kLimitX, 11});
  open();
  runTo(5 * kMs);
  source->drive(kEncoderA, true, 30 * kMs);
  source->drive(kLimitX, true, 4 * kMs + 1);
  runTo(12 * kMs);
  const GpioLiveRecord record = source->finish(50 * kMs);
  EXPECT_EQ(record.lag.edges(), 1U);
  EXPECT_EQ(record.lag.worst_ns(), 0);
  EXPECT_EQ(record.switch_lag.edges(), 1U);
  EXPECT_EQ(record.switch_lag.worst_ns(), static_cast<std::int64_t>(kMs + GpioLiveSource::kHoldBack_ns) - 1);
}

TEST_F(GpioLiveSourceTest, EdgesComeInTheQuantumOfTheirStampsWheneverTheyAreRead) {
  open();
  kernel->edge(kOrigin + 2 * kMs, 0, true, 1, 1, kOrigin + 2 * kMs + 15 * kMs);
  kernel->edge(kOrigin + 2 * kMs + 5, 1, true, 2, 1, kOrigin + 2 * kMs + 15 * kMs);
  kernel->edge(kOrigin + 9 * kMs, 0, false, 3, 2, kOrigin + 20 * kMs);
  EXPECT_THAT(runTo(30 * kMs),
              ElementsAre(PinEvent{2 * kMs, 0, 0x08, 0x08, 0}, PinEvent{2 * kMs + 5, 0, 0x20, 0x28, 0},
                          PinEvent{9 * kMs, 0, 0x08, 0x20, 0}));
  kernel->level_bits = 0b10;
  const GpioLiveRecord record = source->finish(30 * kMs);
  EXPECT_THAT(record.problems, IsEmpty());
  EXPECT_EQ(record.edges, 3U);
}

TEST_F(GpioLiveSourceTest, TheWatermarkIsTheHoldBackBehindTheClock) {
  open();
  source->advance(7 * kMs, batch);
  EXPECT_EQ(batch.watermark, 7 * kMs);
  EXPECT_EQ(kernel->now_ns(), kOrigin + 7 * kMs + GpioLiveSource::kHoldBack_ns);
}

TEST_F(GpioLiveSourceTest, AnEdgeBehindTheWatermarkSpoilsTheRun) {
  open();
  kernel->edge(kOrigin + 2 * kMs, 0, true, 1, 1, kOrigin + 40 * kMs);
  const std::vector<PinEvent> events = runTo(40 * kMs);
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].flags, PinEvent::kGap);
  EXPECT_GT(events[0].tick, 15 * kMs);
  kernel->level_bits = 0b01;
  EXPECT_THAT(source->finish(40 * kMs).problems,
              ElementsAre(HasSubstr("later than the kernel's threads may be")));
}

TEST_F(GpioLiveSourceTest, ALostEdgeSpoilsTheRun) {
  open();
  kernel->edge(kOrigin + 2 * kMs, 0, true, 1, 1, kOrigin + 2 * kMs);
  kernel->edge(kOrigin + 3 * kMs, 0, true, 3, 2, kOrigin + 3 * kMs);
  const std::vector<PinEvent> events = runTo(40 * kMs);
  EXPECT_TRUE(std::ranges::any_of(events, [](const PinEvent& e) { return (e.flags & PinEvent::kGap) != 0; }));
  kernel->level_bits = 0b01;
  EXPECT_THAT(source->finish(40 * kMs).problems, Contains(HasSubstr("faster than its interrupt thread")));
}

TEST_F(GpioLiveSourceTest, TheLevelsInTheEndAreASecondWitness) {
  open();
  kernel->toggle(kOrigin + 2 * kMs, 0);
  runTo(40 * kMs);
  kernel->level_bits = 0b00;
  EXPECT_THAT(source->finish(40 * kMs).problems, ElementsAre(HasSubstr("galvo_x_pul is low in the end")));
}

// The levels would be those of later edges.
TEST_F(GpioLiveSourceTest, PinsThatMoveInTheEndAreNoWitness) {
  open();
  kernel->toggle(kOrigin + 2 * kMs, 0);
  runTo(40 * kMs);
  kernel->level_bits = 0b00;
  int polls = 0;
  kernel->before_poll = [&](std::uint64_t now) {
    if (++polls == 2) kernel->toggle(now, 0);
  };
  EXPECT_THAT(source->finish(40 * kMs).problems, IsEmpty());
}

TEST_F(GpioLiveSourceTest, LinesThatAreHighAtTheStartAreSoInTheRecording) {
  kernel->level_bits = 0b11;
  options.in.at_start.low = {Signal::kGalvoXPul};
  open();
  EXPECT_THAT(runTo(2 * kMs), ElementsAre(PinEvent{1, 0, 0x28, 0x28, 0}));
  EXPECT_THAT(source->finish(2 * kMs).problems, Contains(HasSubstr("galvo_x_pul is high at the start")));
}

TEST_F(GpioLiveSourceTest, AJobOfTheMachineEndsWithQuietPins) {
  options.ends_when_quiet = true;
  open();
  kernel->toggle(kOrigin + 100 * kMs, 0);
  kernel->toggle(kOrigin + 101 * kMs, 0);
  EXPECT_THAT(runTo(2000 * kMs), SizeIs(2));
  EXPECT_EQ(stop, Stop::kEnded);
  EXPECT_NEAR(static_cast<double>(batch.watermark), 580.0 * kMs, 2.0 * kMs);
  EXPECT_THAT(source->finish(batch.watermark).problems, IsEmpty());
}

TEST_F(GpioLiveSourceTest, TheJobMayRestForAsLongAsTheScenarioSays) {
  options.ends_when_quiet = true;
  options.in.quiet_s = 60;
  open();
  kernel->toggle(kOrigin + 100 * kMs, 0);
  kernel->toggle(kOrigin + 50'000 * kMs, 0);
  EXPECT_THAT(runTo(120'000 * kMs, 100 * kMs), SizeIs(2));
  EXPECT_EQ(stop, Stop::kEnded);
  EXPECT_NEAR(static_cast<double>(batch.watermark), 110'000.0 * kMs, 200.0 * kMs);
}

TEST_F(GpioLiveSourceTest, PinsThatStayQuietAreNoEvidence) {
  options.ends_when_quiet = true;
  open();
  runTo(1000 * kMs);
  EXPECT_EQ(stop, Stop::kReached);
  EXPECT_THAT(source->finish(1000 * kMs).problems, ElementsAre(HasSubstr("no edge came")));
}

TEST_F(GpioLiveSourceTest, ALineThatIsTakenIsAnErrorAndLeavesNothingBehind) {
  for (const std::uint32_t line : {1U, 9U}) {
    kernel->taken = {{line, "someone"}};
    EXPECT_THROW(open(), GpioError);
    EXPECT_THAT(kernel->open_fds, IsEmpty());
    EXPECT_EQ(kernel->real_time, 0);
  }
}

TEST_F(GpioLiveSourceTest, AWireTheWrongWayIsAMistakeOfOurs) {
  options.out.push_back({Signal::kGalvoXPul, 11});
  EXPECT_THROW(open(), std::invalid_argument);
}

TEST_F(GpioLiveSourceTest, AChipThatVanishesEndsTheRun) {
  open();
  kernel->before_poll = [this](std::uint64_t now) {
    if (now > kOrigin + 30 * kMs) kernel->poll_revents = POLLERR | POLLHUP;
  };
  expectLost("the chip has gone while its lines were read");
  EXPECT_LT(batch.watermark, 12 * kMs);
}

TEST_F(GpioLiveSourceTest, AnOutputThatFailsEndsTheRun) {
  open();
  source->drive(kEncoderA, true, 30 * kMs);
  kernel->set_error = ENODEV;
  expectLost("the chip has gone while its lines were driven");
  EXPECT_THAT(source->finish(50 * kMs).sensors, SizeIs(1));
}

TEST_F(GpioLiveSourceTest, AModelThatIsHopelesslySlowEndsTheRun) {
  open();
  runTo(10 * kMs);
  kernel->passTime(300 * kMs);
  expectLost("does not keep up with the clock");
}

// Each read of the kernel's buffer takes time, and meanwhile the next edges are there.
TEST_F(GpioLiveSourceTest, ALineThatOscillatesWithoutEndHoldsNothingUp) {
  for (const int edges_at_once : {1, 63, 64, 200}) {
    options.in.quiet_s = 60;
    open();
    batch = {};
    kernel->before_poll = [&](std::uint64_t /*now_ns*/) {
      for (int i = 0; i < edges_at_once; ++i) {
        kernel->passTime(2'000);
        kernel->toggle(kernel->now_ns(), 0);
      }
      kernel->level_bits = kernel->levelOf(0) ? 1 : 0;
    };
    const std::vector<PinEvent> events = runTo(5 * kMs);
    EXPECT_EQ(stop, Stop::kReached) << edges_at_once;
    EXPECT_GT(events.size(), 2'000U) << edges_at_once;
    EXPECT_LT(kernel->now_ns(), kOrigin + 100 * kMs) << edges_at_once;
    // The levels are no witness against edges that still come.
    EXPECT_THAT(source->finish(5 * kMs).problems, IsEmpty()) << edges_at_once;
    source.reset();
    kernel = std::make_shared<ScriptedKernel>();
  }
}

TEST_F(GpioLiveSourceTest, MoreEdgesThanARecordingHoldsEndTheRun) {
  options.most_edges = 1'000;
  open();
  kernel->before_poll = [this](std::uint64_t /*now_ns*/) {
    kernel->passTime(2'000);
    kernel->toggle(kernel->now_ns(), 0);
  };
  expectLost("more edges came than a recording holds");
  EXPECT_LT(kernel->now_ns(), kOrigin + 100 * kMs);
}

TEST_F(GpioLiveSourceTest, ASerialLineThatHangsUpEndsTheRun) {
  open(uart());
  runTo(10 * kMs);
  serial->hung_up = true;
  expectLost("/dev/ttyS9: the other end has hung up");
}

TEST_F(GpioLiveSourceTest, TheUartIsTheSerialLine) {
  open(uart());
  source->uartWrite(std::vector<std::uint8_t>{1, 2});
  EXPECT_THAT(serial->from_bench, IsEmpty());
  runTo(1 * kMs);
  EXPECT_THAT(serial->from_bench, ElementsAre(1, 2));
  serial->to_bench = {5, 6};
  runTo(2 * kMs);
  EXPECT_THAT(batch.uart, ElementsAre(5, 6));
  const Tick heard = batch.uart_received;
  runTo(3 * kMs);
  EXPECT_THAT(batch.uart, IsEmpty());
  // The answer is handed on at once, and recorded with the time at which it came.
  const GpioLiveRecord record = source->finish(100 * kMs);
  ASSERT_THAT(record.uart, SizeIs(1));
  EXPECT_GT(record.uart[0].tick, GpioLiveSource::kHoldBack_ns);
  EXPECT_EQ(heard, record.uart[0].tick);
  EXPECT_EQ(batch.uart_received, heard) << "there was nothing new";
  EXPECT_THAT(source->finish(10 * kMs).uart, IsEmpty());
}

// Files of recordings require strictly ascending times.
TEST_F(GpioLiveSourceTest, WordsThatAreReadAtOneTimeHaveTimesOfTheirOwn) {
  open(uart());
  int reads = 0;
  serial->before_read = [&] {
    if (++reads <= 3) serial->to_bench = {7};
  };
  kernel->toggle(kOrigin + 2, 0);
  kernel->toggle(kOrigin + 2, 1);
  runTo(3 * kMs);
  const GpioLiveRecord record = source->finish(100 * kMs);
  ASSERT_THAT(record.uart, SizeIs(3));
  EXPECT_LT(record.uart[0].tick, record.uart[1].tick);
  EXPECT_LT(record.uart[1].tick, record.uart[2].tick);
}

TEST_F(GpioLiveSourceTest, WhatCameOverTheLineBeforeTheStartIsOfAnotherRun) {
  open(uart());
  serial->to_bench = {5, 6};
  runTo(5 * kMs);
  EXPECT_THAT(batch.uart, IsEmpty());
  EXPECT_THAT(source->finish(5 * kMs).uart, IsEmpty());
}

TEST_F(GpioLiveSourceTest, SaysWhatItIs) {
  open();
  EXPECT_EQ(source->info().rate, (TickRate{1, 1'000'000'000}));
  EXPECT_TRUE(source->info().accepts_input);
  EXPECT_FALSE(source->info().deterministic);
  EXPECT_EQ(source->info().stamp_err_ticks, 20'000U);
}

TEST_F(GpioLiveSourceTest, PriorityIsAskedForAndItsLackIsTold) {
  kernel->priority_error = EPERM;
  open();
  EXPECT_THAT(source->finish(0).notes, ElementsAre(HasSubstr("no real-time priority")));
  source.reset();
  kernel->priority_error = 0;
  open();
  EXPECT_EQ(kernel->real_time, 1);
  source.reset();
  EXPECT_EQ(kernel->real_time, 0);
}

}  // namespace
}  // namespace kerfbench::source

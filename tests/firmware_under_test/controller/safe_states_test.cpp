// SPDX-License-Identifier: Apache-2.0
// Each fault of protocol.h: laser off in time, axes at rest, the reason reported, no START without a new
// CONFIG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "runner.h"

namespace kerfbench::controller_test {
namespace {

using planner::Link;
using planner::Program;

constexpr int kTicksPerPeriod = KB_TICKS_PER_PERIOD;
constexpr double kNominal = 16.0;                      // counts a period
constexpr double kMark = 8000.0;                       // The queue is full before the mark comes.
constexpr long kRampSteps = 2L * 31 + 15 + 7 + 3 + 1;  // The period offered, one under way, and the ramp.
constexpr int kEncoderTicks = (2 * 2 + 2) * kTicksPerPeriod;  // two windows of two periods, and two to act

/// Program that is lit all the time, galvo_x at full speed; follows the belt with galvo_y from a print mark
/// on.
Program litProgram(bool follow, double most_counts = 0.0) {
  Program program;
  program.config = config(follow ? kNominal : 0.0, 0, 0, most_counts);
  if (follow) {
    program.ops.push_back({KB_OP_WAIT_MARK, 0, 0, 0, 0});
    program.ops.push_back({KB_OP_FOLLOW, KB_GALVO_Y + 1});
    program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | KB_OP_GAIN | 1, 31, 200, 0x00, 0x10});
  }
  for (int i = 0; i < 2000; ++i) program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | 1, 31, 200});
  program.ops.push_back({KB_OP_END});
  return program;
}

struct SafeCase {
  const char* name;
  bool follow;
  double most_counts;          // Limit of the belt's speed in the configuration.
  void (*provoke)(Runner&);    // Called once.
  void (*each_tick)(Runner&);  // Called at each tick after the provocation.
  int off_ticks;               // Most ticks from the provocation until the laser is off.
  std::uint8_t fault;
  const char* message;
};

void nothing(Runner&) {}

class SafeState : public testing::TestWithParam<SafeCase> {};

TEST_P(SafeState, LaserOffAxesAtRestReasonToldAndNoStartWithoutConfig) {
  const SafeCase& test_case = GetParam();
  Runner runner;
  fake.belt_counts_per_tick = kNominal / kTicksPerPeriod;
  fake.next_mark_count = kMark;
  const Program program = litProgram(test_case.follow, test_case.most_counts);
  Link link(program);
  std::uint64_t caused = 0;
  long steps_then = 0;
  std::vector<std::uint8_t> heard;
  runner.listen = [&](std::uint8_t byte) { heard.push_back(byte); };
  runner.runProgram(link, 5.0, [&] {
    if (caused == 0 && runner.edges[0] == 31 * 300 + 5) {
      ASSERT_TRUE(runner.gate_before);
      caused = fake.tick;
      steps_then = runner.edges[0];
      test_case.provoke(runner);
    }
    if (caused != 0) test_case.each_tick(runner);
  });
  ASSERT_NE(caused, 0U);
  EXPECT_EQ(link.state(), Link::State::kFailed);
  EXPECT_THAT(link.message(), testing::HasSubstr(test_case.message));
  ASSERT_EQ(runner.gate_falls.size(), 1U);
  const auto off_after = static_cast<int>(runner.gate_falls[0] - caused);
  EXPECT_LE(off_after, test_case.off_ticks);
  RecordProperty("off_after_ticks", off_after);
  // The axes stand, and stay so.
  const long moved = runner.edges[0] - steps_then;
  EXPECT_LE(moved, 31L * (off_after / kTicksPerPeriod + 1) + kRampSteps);
  const auto edges = runner.edges;
  runner.cut_line = false;
  runner.run(4000);
  EXPECT_EQ(runner.edges, edges);
  EXPECT_EQ(runner.gate_rises.size(), 1U);
  for (int axis = 0; axis < KB_AXES && test_case.fault != KB_FAULT_WATCHDOG; ++axis) {
    EXPECT_EQ(fakePosition(axis), runner.pulses[static_cast<std::size_t>(axis)]) << axis;
  }
  const auto event = frame(KB_EVENT, 0, {KB_STOPPED, test_case.fault});
  EXPECT_NE(std::search(heard.begin(), heard.end(), event.begin(), event.end()), heard.end());
  // A new start is refused, with and without data, until there is a new configuration.
  fake.inputs = 0x04;
  runner.run(40 * kTicksPerPeriod);
  EXPECT_EQ(runner.ask(frame(KB_START, 201, JobCheck::accepted().bytes())),
            frame(KB_NAK, 201, {KB_NAK_STATE}));
  EXPECT_EQ(runner.ask(JobCheck::accepted().data(202, {KB_OP_END})), frame(KB_NAK, 202, {KB_NAK_STATE}));
  runner.ask(frame(KB_STOP, 203));
  JobCheck check = JobCheck::accepted();
  EXPECT_EQ(runner.ask(check.data(204, {KB_OP_END})), frame(KB_ACK, 204, {0xFE, 0x0F}));
  EXPECT_EQ(runner.ask(frame(KB_START, 205, check.bytes())), frame(KB_NAK, 205, {KB_NAK_STATE}));
  runner.ask(frame(KB_CONFIG, 206, program.config));
  JobCheck anew(program.config);
  runner.ask(anew.data(207, {KB_OP_END}));
  const auto started = runner.ask(frame(KB_START, 208, anew.bytes()));
  const auto running = frame(KB_EVENT, 0, {KB_RUNNING, KB_OK});
  EXPECT_NE(std::search(started.begin(), started.end(), running.begin(), running.end()), started.end());
}

INSTANTIATE_TEST_SUITE_P(
    Causes, SafeState,
    testing::Values(SafeCase{"Interlock", false, 0.0, [](Runner&) { fake.inputs = 0x00; }, nothing, 2,
                             KB_FAULT_INTERLOCK, "interlock"},
                    // The guard closes again before the main loop can have seen it for long: the controller
                    // stays stopped.
                    SafeCase{"InterlockForAMoment", false, 0.0, [](Runner&) { fake.inputs = 0x00; },
                             [](Runner& r) {
                               if (!r.gate_before) fake.inputs = 0x04;
                             },
                             2, KB_FAULT_INTERLOCK, "interlock"},
                    SafeCase{"LimitX", false, 0.0, [](Runner&) { fake.inputs = 0x05; }, nothing, 2,
                             KB_FAULT_LIMIT, "end-of-travel"},
                    SafeCase{"LimitY", false, 0.0, [](Runner&) { fake.inputs = 0x06; }, nothing, 2,
                             KB_FAULT_LIMIT, "end-of-travel"},
                    SafeCase{"HostSilent", false, 0.0, [](Runner& r) { r.cut_line = true; }, nothing,
                             static_cast<int>(KB_SILENCE_PERIODS + 1) * kTicksPerPeriod + 2, KB_FAULT_SILENT,
                             "heard nothing"},
                    // Bytes on the line are no sign of life; frames are.
                    SafeCase{"HostBabbles", false, 0.0, [](Runner& r) { r.cut_line = true; },
                             [](Runner& r) { r.babble.push_back(0x55); },
                             static_cast<int>(KB_SILENCE_PERIODS + 1) * kTicksPerPeriod + 2, KB_FAULT_SILENT,
                             "heard nothing"},
                    SafeCase{"LineBroken", false, 0.0,
                             [](Runner& r) {
                               r.cut_line = true;
                               fake.rx_errors = KB_LINE_ERRORS_MAX;
                             },
                             nothing, kTicksPerPeriod + 2, KB_FAULT_UART, "disturbed"},
                    SafeCase{"EncoderALost", true, 0.0, [](Runner&) { fake.a_lost = true; }, nothing,
                             kEncoderTicks, KB_FAULT_ENCODER, "encoder"},
                    SafeCase{"EncoderBLost", true, 0.0, [](Runner&) { fake.b_lost = true; }, nothing,
                             kEncoderTicks, KB_FAULT_ENCODER, "encoder"},
                    SafeCase{"BeltRunsBack", true, 0.0, [](Runner&) { fake.belt_counts_per_tick *= -1.0; },
                             nothing, kEncoderTicks, KB_FAULT_ENCODER, "encoder"},
                    SafeCase{"EncoderNoise", true, 0.0,
                             [](Runner&) {
                               for (unsigned i = 0; i <= KB_ENCODER_ERRORS_MAX; ++i) fakeEdge(true, true);
                             },
                             nothing, kTicksPerPeriod + 2, KB_FAULT_ENCODER, "encoder"},
                    SafeCase{"BeltTooFast", true, 20.0,
                             [](Runner&) { fake.belt_counts_per_tick = 24.0 / kTicksPerPeriod; }, nothing,
                             (12 + static_cast<int>(KB_BELT_FAST_PERIODS)) * kTicksPerPeriod,
                             KB_FAULT_BELT_FAST, "too fast"},
                    // No limit was configured, but 60 - 16 counts are more steps than a period has.
                    SafeCase{"AxisCannotKeepUp", true, 0.0,
                             [](Runner&) { fake.belt_counts_per_tick = 60.0 / kTicksPerPeriod; }, nothing,
                             (12 + static_cast<int>(KB_BELT_FAST_PERIODS)) * kTicksPerPeriod,
                             KB_FAULT_BELT_FAST, "too fast"},
                    SafeCase{"MarksLost", true, 0.0,
                             [](Runner&) {
                               fake.mark_pitch_counts = 0.125;
                               fake.next_mark_count = fake.belt_count + 0.125;
                             },
                             nothing, 3 * kTicksPerPeriod, KB_FAULT_MARKS, "print marks"},
                    SafeCase{"WatchdogReset", false, 0.0, [](Runner&) { fakeWatchdogReset(); }, nothing, 2,
                             KB_FAULT_WATCHDOG, "watchdog"}),
    [](const auto& instance) { return std::string(instance.param.name); });

// Deviations of a healthy run that must not stop it.
TEST(Watch, ToleratesALineThatPausesAndABeltThatVaries) {
  for (const double factor : {0.4, 1.2}) {
    Runner runner;
    fake.belt_counts_per_tick = kNominal / kTicksPerPeriod;
    fake.next_mark_count = kMark;
    Link link(litProgram(true, 20.0));
    std::uint64_t cut = 0;
    runner.runProgram(link, 5.0, [&] {
      if (runner.edges[0] == 31 * 100) fake.belt_counts_per_tick = factor * kNominal / kTicksPerPeriod;
      if (cut == 0 && runner.edges[0] == 31 * 500) cut = fake.tick;
      runner.cut_line = cut != 0 && fake.tick < cut + 200 * kTicksPerPeriod;
    });
    EXPECT_EQ(link.state(), Link::State::kDone) << factor << ": " << link.message();
  }
}

TEST(Watch, ABeltAtRestBetweenUnitsIsNoFault) {
  Runner runner;
  fake.belt_counts_per_tick = 0.0;
  fake.next_mark_count = kMark;
  Link link(litProgram(true));
  runner.runProgram(link, 2.0);
  EXPECT_EQ(link.state(), Link::State::kRunning) << link.message();
  EXPECT_TRUE(runner.gate_rises.empty());
}

TEST(Watchdog, IsFedOnceAPeriodByTheMainLoopAlone) {
  Runner runner;
  runner.run(100 * kTicksPerPeriod);
  EXPECT_NEAR(static_cast<double>(fake.fed), 100.0, 1.0);
}

}  // namespace
}  // namespace kerfbench::controller_test

// SPDX-License-Identifier: Apache-2.0
// Field of KB_CONFIG: with the laser on no axis begins or ends a period beyond it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "runner.h"

namespace kerfbench::controller_test {
namespace {

using planner::Link;
using planner::Program;

constexpr long kRamp = 15 + 7 + 3 + 1;

std::vector<std::uint8_t> move(int steps, bool lit) {
  std::vector<std::uint8_t> op{static_cast<std::uint8_t>(KB_OP_MOVE | (lit ? KB_OP_POWER : 0) | 1),
                               static_cast<std::uint8_t>(static_cast<std::int8_t>(steps))};
  if (lit) op.push_back(200);
  return op;
}

Program programOf(const std::vector<std::vector<std::uint8_t>>& ops, std::int32_t lowest,
                  std::int32_t highest) {
  Program program;
  program.config = config();
  setField(program.config, KB_GALVO_X, lowest, highest);
  program.ops = ops;
  program.ops.push_back({KB_OP_END});
  return program;
}

struct Outcome {
  Link::State state{};
  std::string message;
  long at_dark{};  ///< Steps of the axis when the gate closed for good.
  long at_rest{};
};

Outcome run(Runner& runner, const Program& program, std::size_t axis = KB_GALVO_X) {
  Link link(program);
  Outcome outcome;
  std::size_t falls = 0;
  runner.runProgram(link, 5.0, [&] {
    if (runner.gate_falls.size() == falls) return;
    falls = runner.gate_falls.size();
    outcome.at_dark = runner.pulses[axis];
  });
  runner.run(4000);
  EXPECT_FALSE(runner.gate_before);
  EXPECT_EQ(fakePosition(static_cast<int>(axis)), runner.pulses[axis]);
  outcome.state = link.state();
  outcome.message = link.message();
  outcome.at_rest = runner.pulses[axis];
  return outcome;
}

TEST(Field, IsNotLeftWithTheLaserOnEitherWay) {
  for (const int sign : {1, -1}) {
    Runner runner;
    const std::vector<std::vector<std::uint8_t>> ops(200, move(31 * sign, true));
    const Outcome outcome = run(runner, programOf(ops, sign > 0 ? -100 : -3110, sign > 0 ? 3110 : 100));
    EXPECT_EQ(outcome.state, Link::State::kFailed);
    EXPECT_THAT(outcome.message, testing::HasSubstr("out of its field"));
    // The period that would end at 3131 is not begun; the one before it is under way.
    EXPECT_LE(std::labs(outcome.at_dark), 3100);
    EXPECT_GT(std::labs(outcome.at_dark), 3100 - 62);
    EXPECT_EQ(std::labs(outcome.at_rest), 3100 + kRamp);
    EXPECT_EQ(runner.gate_rises.size(), 1U);
  }
}

TEST(Field, ItsEdgeIsWithin) {
  const std::vector<std::vector<std::uint8_t>> ops(100, move(31, true));
  Runner runner;
  EXPECT_EQ(run(runner, programOf(ops, 0, 3100)).state, Link::State::kDone);
  Runner other;
  EXPECT_EQ(run(other, programOf(ops, 0, 3099)).state, Link::State::kFailed);
  Runner third;
  EXPECT_EQ(run(third, programOf(ops, 1, 3100)).state, Link::State::kFailed) << "it begins outside";
}

TEST(Field, MayBeLeftInTheDark) {
  std::vector<std::vector<std::uint8_t>> ops{move(31, true), move(31, false), move(-31, false),
                                             move(31, true)};
  Runner runner;
  EXPECT_EQ(run(runner, programOf(ops, 0, 62)).state, Link::State::kDone);
  ops = {move(31, true), move(31, false), move(31, false), move(-31, false), move(31, false)};
  Runner dark;
  EXPECT_EQ(run(dark, programOf(ops, 0, 31)).state, Link::State::kDone);
  // The beam may not enter the field from outside with the laser on.
  ops = {move(31, true), move(31, false), move(-31, true)};
  Runner lit;
  const Outcome outcome = run(lit, programOf(ops, 0, 31));
  EXPECT_EQ(outcome.state, Link::State::kFailed);
  EXPECT_EQ(lit.gate_rises.size(), 1U);
}

TEST(Field, OtherAxesThanTheFirstAreWatched) {
  for (int axis = 0; axis < KB_AXES; ++axis) {
    Program program = programOf({}, 0, 0);
    program.ops.assign(100, {static_cast<std::uint8_t>(KB_OP_MOVE | KB_OP_POWER | 1U << axis), 20, 200});
    program.ops.push_back({KB_OP_END});
    setField(program.config, axis, 0, 1000);
    Runner runner;
    const Outcome outcome = run(runner, program, static_cast<std::size_t>(axis));
    EXPECT_THAT(outcome.message, testing::HasSubstr("out of its field")) << axis;
    EXPECT_LE(outcome.at_dark, 1000) << axis;
  }
}

// The belt is faster than planned, but not so fast that it stops the job by itself.
TEST(Field, WhatFollowsTheBeltIsWatchedToo) {
  constexpr double kNominal = 16.0;
  Runner runner;
  fake.belt_counts_per_tick = 1.1 * kNominal / KB_TICKS_PER_PERIOD;
  fake.next_mark_count = 8000.0;
  Program program;
  program.config = config(kNominal, 0, 0, 1.2 * kNominal);
  setField(program.config, KB_GALVO_Y, -10, 500);
  program.ops = {{KB_OP_WAIT_MARK, 0, 0, 0, 0},
                 {KB_OP_FOLLOW, KB_GALVO_Y + 1},
                 {KB_OP_MOVE | KB_OP_POWER | KB_OP_GAIN | 1, 5, 200, 0x00, 0x10}};
  program.ops.resize(1000, {KB_OP_MOVE | KB_OP_POWER | 1, 5, 200});
  program.ops.push_back({KB_OP_END});
  const Outcome outcome = run(runner, program, KB_GALVO_Y);
  EXPECT_THAT(outcome.message, testing::HasSubstr("out of its field"));
  EXPECT_LE(outcome.at_dark, 500);
  EXPECT_GT(outcome.at_dark, 495);
  EXPECT_LE(outcome.at_rest, 502);
}

TEST(Field, ThatEndsBeforeItBeginsIsRefused) {
  std::vector<std::uint8_t> bytes = config();
  setField(bytes, KB_FEED, 5, 4);
  Runner runner;
  EXPECT_EQ(runner.ask(frame(KB_CONFIG, 1, bytes)), frame(KB_NAK, 1, {KB_NAK_VALUE}));
  setField(bytes, KB_FEED, 5, 5);
  EXPECT_EQ(runner.ask(frame(KB_CONFIG, 2, bytes)), frame(KB_ACK, 2, {0xFF, 0x0F}));
}

}  // namespace
}  // namespace kerfbench::controller_test

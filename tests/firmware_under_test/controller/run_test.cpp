// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runner.h"

namespace kerfbench::controller_test {
namespace {

using planner::Link;
using planner::Program;

struct RandomProgram {
  Program program;
  std::array<long, KB_AXES> steps{}, edges{};
};

RandomProgram randomProgram(int periods, unsigned seed) {
  std::mt19937 random(seed);
  RandomProgram result;
  result.program.config = config(0.0, 10, 5);
  for (int i = 0; i < periods; ++i) {
    const unsigned mask = random() & 0x1FU;
    const bool lit = (random() & 1U) != 0;
    std::vector<std::uint8_t> op{static_cast<std::uint8_t>(KB_OP_MOVE | mask | (lit ? KB_OP_POWER : 0))};
    for (std::size_t axis = 0; axis < KB_AXES; ++axis) {
      if ((mask >> axis & 1U) == 0) continue;
      const int count = static_cast<int>(random() % 63) - 31;
      result.steps[axis] += count;
      result.edges[axis] += std::abs(count);
      op.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(count)));
    }
    if (lit) op.push_back(static_cast<std::uint8_t>(random()));
    result.program.ops.push_back(op);
  }
  result.program.ops.push_back({KB_OP_END});
  return result;
}

TEST(Run, RandomProgramsMakeExactlyTheirSteps) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const RandomProgram random = randomProgram(1500, seed);
    Runner runner;
    Link link(random.program);
    runner.runProgram(link, 10.0);
    ASSERT_EQ(link.state(), Link::State::kDone) << link.message();
    EXPECT_EQ(runner.pulses, random.steps);
    EXPECT_EQ(runner.edges, random.edges);
    for (int axis = 0; axis < KB_AXES; ++axis) {
      EXPECT_EQ(fakePosition(axis), random.steps[static_cast<std::size_t>(axis)]);
    }
    // DIR is stable from the end of the tick before its pulse to the end of the pulse, and PUL is low
    // between.
    EXPECT_TRUE(runner.dir_kept);
    EXPECT_TRUE(runner.pulse_low);
  }
}

TEST(Run, ALossyLineCostsTimeButNoStep) {
  RandomProgram random = randomProgram(600, 3);
  Runner runner;
  runner.loss = 0.001;
  Link link(random.program);
  runner.runProgram(link, 20.0);
  ASSERT_EQ(link.state(), Link::State::kDone) << link.message();
  EXPECT_EQ(runner.pulses, random.steps);
}

TEST(Run, ASilentControllerIsAFailureAfterTwoSeconds) {
  Link link(randomProgram(1, 1).program);
  double now_s = 0.0;
  for (; link.state() != Link::State::kFailed && now_s < 5.0; now_s += 0.01) link.step({}, now_s);
  EXPECT_NEAR(now_s, 2.0, 0.05);
  EXPECT_THAT(link.message(), testing::HasSubstr("does not answer"));
}

TEST(Run, PowerIsExactAndTheGateWaitsForItsDelay) {
  Program program;
  program.config = config(0.0, 40, 20);
  program.ops.push_back({KB_OP_WAIT, 20, 0});
  for (int i = 0; i < 255; ++i) program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | 1, 1, 100});
  program.ops.push_back({KB_OP_END});
  Runner runner;
  std::uint64_t first_pulse = 0;
  Link link(program);
  runner.runProgram(link, 5.0, [&] {
    if (first_pulse == 0 && runner.edges[0] == 1) first_pulse = fake.tick;
  });
  ASSERT_EQ(link.state(), Link::State::kDone) << link.message();
  ASSERT_EQ(runner.gate_rises.size(), 1U);
  ASSERT_EQ(runner.gate_falls.size(), 1U);
  // A single step comes in the middle of its period: tick 16 of 32, the first being 1.
  EXPECT_EQ(runner.gate_rises[0], first_pulse - 15 + 40);
  EXPECT_EQ(runner.gate_ticks, 255 * 32 - 20);
  EXPECT_NEAR(static_cast<double>(runner.pwm_ticks), static_cast<double>(runner.gate_ticks) * 100.0 / 255.0,
              1.0);
}

TEST(Run, AQueueThatRunsDryPutsTheLaserOutAndSlowsDown) {
  Program program;
  program.config = config();
  for (int i = 0; i < 40; ++i) program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | 1, 31, 255});
  Runner runner;
  Link link(program);
  runner.runProgram(link, 2.0);
  EXPECT_EQ(link.state(), Link::State::kFailed);
  EXPECT_THAT(link.message(), testing::HasSubstr("ran dry"));
  EXPECT_EQ(runner.pulses[0], 40 * 31 + 15 + 7 + 3 + 1);
  EXPECT_LE(runner.gate_ticks, 40 * 32);
  EXPECT_GE(runner.gate_ticks, 40 * 32 - 10);
  runner.run(320);
  EXPECT_EQ(fakePosition(0), runner.pulses[0]);
}

TEST(Run, ARampDoesNotMakeUpForAReversalThatWasPutOff) {
  Program program;
  program.config = config();
  program.config[22] = 4;                      // most steps of axis 0 next to a change of DIR
  program.ops.push_back({KB_OP_MOVE | 1, 4});  // DIR changes here, too
  for (int i = 0; i < 40; ++i) program.ops.push_back({KB_OP_MOVE | 1, 31});
  for (int i = 0; i < 2; ++i) program.ops.push_back({KB_OP_MOVE | 1, 0xE1});
  Runner runner;
  Link link(program);
  runner.runProgram(link, 2.0);
  EXPECT_THAT(link.message(), testing::HasSubstr("queue"));
  runner.run(320);
  EXPECT_EQ(fakePosition(0), 4 + 40 * 31 - 4 - 2 - 1) << "a period at rest, four steps back, and the ramp";
  EXPECT_EQ(fakePosition(0), runner.pulses[0]);
  EXPECT_TRUE(runner.dir_kept);
}

class StopsAtOnce : public testing::TestWithParam<std::pair<std::uint8_t, const char*>> {};

TEST_P(StopsAtOnce, WithTheLaserOffAndAnHonestPosition) {
  Program program;
  program.config = config();
  for (int i = 0; i < 400; ++i) program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | 3, 31, 0xEF, 255});
  program.ops.push_back({KB_OP_END});
  for (int after = 1000; after < 1064; after += 3) {
    Runner runner;
    Link link(program);
    std::uint64_t opened = 0;
    runner.runProgram(link, 2.0, [&] {
      if (opened == 0 && runner.edges[0] == after) {
        opened = fake.tick;
        fake.inputs = GetParam().first;
      }
    });
    EXPECT_EQ(link.state(), Link::State::kFailed);
    EXPECT_THAT(link.message(), testing::HasSubstr(GetParam().second));
    ASSERT_EQ(runner.gate_falls.size(), 1U);
    EXPECT_LE(runner.gate_falls[0], opened + 2);
    runner.run(100);
    EXPECT_LE(runner.edges[0], after + 2);
    EXPECT_EQ(fakePosition(0), runner.pulses[0]);
    EXPECT_EQ(fakePosition(1), runner.pulses[1]);
  }
}

INSTANTIATE_TEST_SUITE_P(Inputs, StopsAtOnce,
                         testing::Values(std::pair<std::uint8_t, const char*>{0x00, "interlock"},
                                         std::pair<std::uint8_t, const char*>{0x05, "end-of-travel"},
                                         std::pair<std::uint8_t, const char*>{0x06, "end-of-travel"}));

TEST(Run, AProgramThatAsksTooMuchIsRefused) {
  for (const auto& [op, why] :
       {std::pair<std::vector<std::uint8_t>, const char*>{{KB_OP_MOVE | 1, 32}, "more steps"},
        {{0x10}, "does not know"},
        {{KB_OP_FOLLOW, 6}, "does not know"}}) {
    Program program{config(), {{KB_OP_MOVE | 1, 31}, op, {KB_OP_END}}};
    Runner runner;
    Link link(program);
    runner.runProgram(link, 2.0);
    EXPECT_THAT(link.message(), testing::HasSubstr(why));
    runner.run(100);
    EXPECT_EQ(fakePosition(0), runner.pulses[0]);
  }
}

}  // namespace
}  // namespace kerfbench::controller_test

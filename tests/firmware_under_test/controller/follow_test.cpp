// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "runner.h"

namespace kerfbench::controller_test {
namespace {

using planner::Link;
using planner::Program;

TEST(Belt, TheFilterHasNoLagAtConstantSpeed) {
  for (const double counts_per_period : {0.7, 5.3, 16.0, 31.7, -16.0}) {
    Runner runner;
    fake.belt_counts_per_tick = counts_per_period / 32;
    runner.run(32 * 600);
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
      const std::int32_t expected = fakeBeltAhead256(1);
      runner.run(1);  // The boundary is the first tick of a period.
      worst = std::max(worst, std::abs(expected / 256.0 - fake.belt_count));
      runner.run(31);
    }
    EXPECT_LT(worst, 0.6) << counts_per_period << " counts a period";
  }
}

Program followProgram(int periods, double nominal, int offset) {
  Program program;
  program.config = config(nominal);
  program.ops.push_back({KB_OP_FOLLOW, KB_GALVO_X + 1});
  program.ops.push_back(
      {KB_OP_WAIT_MARK, static_cast<std::uint8_t>(offset), static_cast<std::uint8_t>(offset >> 8), 0, 0});
  program.ops.push_back({KB_OP_MOVE | KB_OP_GAIN, 0x00, 0x10});  // The gain is a step a count.
  for (int i = 1; i < periods; ++i) program.ops.push_back({KB_OP_MOVE | 2, 1});
  program.ops.push_back({KB_OP_END});
  return program;
}

TEST(Follow, TheAxisStaysWithABeltThatIsOnePercentOff) {
  for (const double factor : {1.01, 0.99}) {
    constexpr double kNominal = 16.0;
    constexpr int kOffset = 200;
    Runner runner;
    fake.belt_counts_per_tick = kNominal * factor / 32;
    fake.next_mark_count = 8000.0;
    Link link(followProgram(1000, kNominal, kOffset));
    double start_tick = 0.0;
    double worst = 0.0;
    runner.runProgram(link, 5.0, [&] {
      // The gantry's step in the second period, in the middle of that period, marks the time.
      if (runner.edges[1] == 1 && start_tick == 0.0) start_tick = static_cast<double>(fake.tick) - 48.0;
      if (runner.edges[1] < 10 || runner.edges[1] >= 998) return;
      const double periods = (static_cast<double>(fake.tick) - start_tick) / 32.0;
      const double ahead = (fake.belt_count - 8000.0) - (kOffset + periods * kNominal);
      worst = std::max(worst, std::abs(ahead - static_cast<double>(runner.pulses[0])));
    });
    ASSERT_EQ(link.state(), Link::State::kDone) << link.message();
    EXPECT_LT(worst, 1.7);
    EXPECT_EQ(runner.pulses[0], 0) << "after END the correction is back at zero";
  }
}

TEST(Mark, NoUnitIsLostWhenMarksComeWhileOneRuns) {
  Program program;
  program.config = config(16.0);
  for (int unit = 0; unit < 12; ++unit) {
    program.ops.push_back({KB_OP_WAIT_MARK, 0x10, 0x27, 0, 0});  // 10 000 counts beyond: three pitches
    for (int i = 0; i < 150; ++i) program.ops.push_back({KB_OP_MOVE | 1, 1});
  }
  program.ops.push_back({KB_OP_END});
  Runner runner;
  fake.belt_counts_per_tick = 0.5;
  fake.next_mark_count = 8000.0;
  fake.mark_pitch_counts = 3000.0;
  Link link(program);
  std::vector<double> starts;
  runner.runProgram(link, 10.0, [&] {
    if (runner.edges[0] == static_cast<long>(starts.size()) * 150 + 1) starts.push_back(fake.belt_count);
  });
  ASSERT_EQ(link.state(), Link::State::kDone) << link.message();
  ASSERT_EQ(starts.size(), 12U);
  for (std::size_t unit = 0; unit < starts.size(); ++unit) {
    const double due = 8000.0 + 10000.0 + 3000.0 * static_cast<double>(unit);
    EXPECT_GE(starts[unit], due - 1.0);
    EXPECT_LT(starts[unit], due + 16.0 + 9.0) << "a period, and half of one to the first step";
  }
}

}  // namespace
}  // namespace kerfbench::controller_test

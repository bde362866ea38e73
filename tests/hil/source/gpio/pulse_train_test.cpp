// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/pulse_train.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/hil/source/gpio/scripted_kernel.h"

namespace kerfbench::source {
namespace {

constexpr std::uint64_t kStart_ns = ScriptedKernel::kStart_ns;

class PulseTrainTest : public testing::Test {
 protected:
  OutputLines line() { return {kernel, "/dev/gpiochip0", {{4, "out"}}, {false}}; }
  DrivenTrain play(const TrainPlan& plan) {
    OutputLines out = line();
    return playTrain(*kernel, out, plan);
  }
  void TearDown() override { EXPECT_THAT(kernel->open_fds, testing::IsEmpty()); }
  const std::shared_ptr<ScriptedKernel> kernel = std::make_shared<ScriptedKernel>();
};

TEST_F(PulseTrainTest, EdgesComeAtTheirTimesHighFirstAndLowInTheEnd) {
  kernel->set_takes_ns = 2'000;
  const DrivenTrain train = play({.edges = 4, .period_ns = 100'000});
  ASSERT_EQ(train.edges.size(), 4U);
  ASSERT_EQ(kernel->driven.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(kernel->driven[i].at_ns, kStart_ns + (i + 1) * 100'000);
    EXPECT_EQ(kernel->driven[i].bits, i % 2 == 0 ? 1U : 0U);
    EXPECT_EQ(train.edges[i].before_ns, kernel->driven[i].at_ns);
    EXPECT_EQ(train.edges[i].after_ns, kernel->driven[i].at_ns + 2'000);
  }
  EXPECT_DOUBLE_EQ(train.rate_hz(), 10'000.0);
  EXPECT_EQ(train.lag.worst_ns(), 2'000);
  EXPECT_EQ(train.lag.edges(), 4U);
}

TEST_F(PulseTrainTest, ATrainThatWasHeldUpCatchesUpWithoutABurst) {
  bool held_up = false;
  kernel->before_poll = [&](std::uint64_t now_ns) {
    if (!std::exchange(held_up, now_ns > kStart_ns + 250'000) && held_up) kernel->passTime(400'000);
  };
  const DrivenTrain train = play({.edges = 20, .period_ns = 100'000});
  ASSERT_EQ(train.edges.size(), 20U);
  for (std::size_t i = 1; i < 20; ++i)
    EXPECT_GE(train.edges[i].before_ns, train.edges[i - 1].before_ns + 50'000) << i;
  EXPECT_EQ(train.edges.back().before_ns, kStart_ns + 20 * 100'000U) << "it has caught up";
  EXPECT_EQ(train.lag.worst_ns(), 400'000);
}

TEST_F(PulseTrainTest, AnOutputThatIsTooSlowIsGivenUpBehindAWholePulse) {
  kernel->set_takes_ns = 10'000'000;
  const DrivenTrain train = play({.edges = 1'000, .period_ns = 100'000});
  // The plan takes 0.1 s, a quarter of it and 0.1 s more: 22 or 23 edges of 10 ms.
  EXPECT_GE(train.edges.size(), 22U);
  EXPECT_LE(train.edges.size(), 24U);
  EXPECT_EQ(train.edges.size() % 2, 0U);
  EXPECT_LT(train.rate_hz(), 101.0);
}

TEST_F(PulseTrainTest, TooFewEdgesHaveNoRate) { EXPECT_EQ(DrivenTrain{}.rate_hz(), 0.0); }

TEST_F(PulseTrainTest, AThreadDoesTheSameBelowTheReadersPriority) {
  ThreadTrain train(kernel, line());
  train.set(true);
  train.set(false);
  train.begin({.edges = 6, .period_ns = 50'000});
  EXPECT_EQ(train.end().edges.size(), 6U);
  EXPECT_EQ(kernel->driven.size(), 8U);
  EXPECT_EQ(kernel->real_time, 1);
}

TEST_F(PulseTrainTest, AChipThatVanishesEndsTheThreadInWords) {
  ThreadTrain train(kernel, line());
  kernel->set_error = ENODEV;
  train.begin({.edges = 6, .period_ns = 50'000});
  try {
    (void)train.end();
    ADD_FAILURE() << "no error";
  } catch (const GpioError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("the chip has gone while its lines were driven"));
  }
}

}  // namespace
}  // namespace kerfbench::source

// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/loop_back.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <cerrno>

#include "tests/hil/source/gpio/jumper_kernel.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LoopBackTest : public testing::Test {
 protected:
  LoopBackTest() { kernel->set_takes_ns = 5'000; }
  std::string trouble() {
    PromptTrain train(kernel);
    return wireTrouble(kernel, lines, train);
  }
  LoopBackStep measure(const TrainPlan& plan = {.edges = 100, .period_ns = 100'000}) {
    PromptTrain train(kernel);
    return measureLoopBack(kernel, lines, train, plan);
  }
  template <typename Work>
  std::string wordsOf(const Work& work) {
    try {
      work();
    } catch (const GpioError& e) {
      return e.what();
    }
    return "no error";
  }
  void TearDown() override { EXPECT_THAT(kernel->open_fds, IsEmpty()); }
  const LoopBackLines lines{"/dev/gpiochip0", {4, "OUT"}, "/dev/gpiochip0", {5, "IN"}, {6, "beside"}};
  const std::shared_ptr<JumperKernel> kernel = std::make_shared<JumperKernel>();
};

TEST_F(LoopBackTest, AWireThatFollowsIsNoTrouble) {
  EXPECT_EQ(trouble(), "");
  EXPECT_EQ(kernel->driven.back().bits, 0U) << "the output is left low";
}

TEST_F(LoopBackTest, AWireThatIsMissingInvertedOrLooseIsSaid) {
  kernel->inverts = true;
  EXPECT_THAT(trouble(), HasSubstr("is the inverse of line 4 (OUT)"));
  kernel->inverts = false;
  kernel->plugged = false;
  EXPECT_EQ(
      trouble(),
      "/dev/gpiochip0: line 5 (IN) stays low whatever line 4 (OUT) of /dev/gpiochip0 does: the jumper is "
      "missing, or on other lines");
  kernel->stuck_high = true;
  EXPECT_THAT(trouble(), HasSubstr("line 5 (IN) stays high"));
  kernel->stuck_high = false;
  int looks = 0;
  kernel->before_poll = [&](std::uint64_t) { kernel->plugged = ++looks < 2; };
  kernel->plugged = true;
  EXPECT_THAT(trouble(), AllOf(HasSubstr("driven 01010, it was "), HasSubstr("has no contact")));
}

TEST_F(LoopBackTest, EveryEdgeThatWasDrivenIsReadAndItsStampIsBetweenTheBounds) {
  kernel->latency_ns = 7'000;  // The latency is longer than the call, which takes 5 us.
  kernel->read_takes_ns = 20'000;
  const LoopBackStep step = measure();
  EXPECT_TRUE(step.held()) << step.problems.front();
  EXPECT_TRUE(step.wasDriven());
  EXPECT_EQ(step.driven, 100U);
  EXPECT_EQ(step.read, 100U);
  EXPECT_EQ(step.beside, 0U);
  EXPECT_DOUBLE_EQ(step.asked_hz, 10'000.0);
  EXPECT_DOUBLE_EQ(step.driven_hz, 10'000.0);
  EXPECT_EQ(step.stamp_most.worst_ns, 7'000U);
  EXPECT_EQ(step.stamp_most.share95_ns, 7'000U);
  EXPECT_DOUBLE_EQ(step.stamp_most.rms_ns, 7'000.0);
  EXPECT_EQ(step.stamp_least.worst_ns, 2'000U);
  EXPECT_EQ(step.worst_put_ns, 5'000);
  // The first edge waits for the last: 99 periods and the rest of the call.
  EXPECT_EQ(step.worst_read_ns, 99U * 100'000 + 5'000 - 7'000);
  // Three reads are made, of 64 edges, of the rest and of the last, in 10 ms.
  EXPECT_NEAR(step.cpu_share, 60'000.0 / 10'007'000, 1e-9);
}

TEST_F(LoopBackTest, AStampWithinTheCallMayBeRight) {
  const LoopBackStep step = measure();
  EXPECT_EQ(step.stamp_most.worst_ns, 3'000U);
  EXPECT_EQ(step.stamp_least.worst_ns, 0U);
}

TEST_F(LoopBackTest, EdgesThatTheKernelMergesAreLost) {
  kernel->merged = {10, 11};
  const LoopBackStep step = measure();
  EXPECT_EQ(step.read, 98U);
  EXPECT_THAT(step.problems, AllOf(Contains(HasSubstr("came faster than its interrupt thread takes them")),
                                   Contains("100 edges were driven, and 98 were read")));
  EXPECT_EQ(step.stamp_most.worst_ns, 0U) << "nobody knows which edge is which";
}

TEST_F(LoopBackTest, LossAtTheEndIsFoundByTheLevelAndByTheNumber) {
  kernel->merged = {99};
  EXPECT_THAT(measure().problems, ElementsAre(HasSubstr("IN is low in the end, and its edges say high"),
                                              HasSubstr("100 edges were driven, and 99 were read")));
}

TEST_F(LoopBackTest, AnInputWithoutInterruptsIsNotHeld) {
  kernel->silent = true;
  const LoopBackStep step = measure();
  EXPECT_THAT(step.problems, ElementsAre("100 edges were driven, and 0 were read"));
  EXPECT_EQ(step.cpu_share, 0.0);
}

TEST_F(LoopBackTest, ALineThatBouncesIsSaid) {
  kernel->bounces = {3};
  EXPECT_THAT(measure().problems,
              ElementsAre("100 edges were driven, and 102 were read: the line bounces or picks up noise"));
}

TEST_F(LoopBackTest, NoiseThatNeverEndsEndsTheMeasurement) {
  std::uint32_t number = 100;
  std::uint32_t line_number = 0;
  kernel->before_poll = [&](std::uint64_t now_ns) {
    ++line_number;
    kernel->edge(now_ns + 50'000'000, 6, line_number % 2 == 1, ++number, line_number, now_ns + 5'000'000);
  };
  const LoopBackStep step = measure({.edges = 2, .period_ns = 100'000});
  EXPECT_GT(step.beside, 0U);
}

TEST_F(LoopBackTest, EdgesOfTheLineBesideAreCountedApart) {
  kernel->beside = 4;
  const LoopBackStep step = measure();
  EXPECT_TRUE(step.held());
  EXPECT_EQ(step.read, 100U);
  EXPECT_EQ(step.beside, 4U);
}

TEST_F(LoopBackTest, StampsBeforeTheirEdgesAreOfAnotherClock) {
  kernel->clock_offset_ns = -4'000;
  EXPECT_THAT(measure().problems, ElementsAre(HasSubstr("100 edges were stamped before they were driven")));
}

TEST_F(LoopBackTest, AnOutputThatIsTooSlowIsSeen) {
  kernel->set_takes_ns = 200'000;
  const LoopBackStep step = measure({.edges = 10, .period_ns = 100'000});
  EXPECT_TRUE(step.held());
  EXPECT_DOUBLE_EQ(step.driven_hz, 5'000.0);
  EXPECT_FALSE(step.wasDriven());
}

TEST_F(LoopBackTest, LinesThatCannotBeHadOrAChipThatVanishesAreToldInWords) {
  kernel->vanishes_at = 7;
  EXPECT_THAT(wordsOf([&] { measure(); }), HasSubstr("the chip has gone while its lines were driven"));
  kernel->vanishes_at = ~0ULL;
  kernel->poll_revents = POLLERR;
  EXPECT_THAT(wordsOf([&] { measure(); }), HasSubstr("the chip has gone while its lines were read"));
  kernel->poll_revents = 0;
  kernel->taken = {{5, "spi"}};
  EXPECT_THAT(wordsOf([&] { trouble(); }), HasSubstr("line 5 for IN is taken by 'spi'"));
  kernel->taken.clear();
  kernel->request_error = EPERM;
  EXPECT_THAT(wordsOf([&] { trouble(); }), HasSubstr("may not be used as inputs"));
}

TEST(TimeSpreadTest, WorstShareAndMeanSquare) {
  std::vector<std::uint64_t> times_ns;
  for (std::uint64_t i = 100; i > 0; --i) times_ns.push_back(i);
  const TimeSpread spread = spreadOf(times_ns);
  EXPECT_EQ(spread.worst_ns, 100U);
  EXPECT_EQ(spread.share95_ns, 95U);
  EXPECT_NEAR(spread.rms_ns, 58.168, 1e-3);  // sqrt(101 * 201 / 6)
  EXPECT_EQ(spreadOf({7}).share95_ns, 7U);
  EXPECT_EQ(spreadOf({}).worst_ns, 0U);
}

}  // namespace
}  // namespace kerfbench::source

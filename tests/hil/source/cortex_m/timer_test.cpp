// SPDX-License-Identifier: Apache-2.0
// Timers of the STM32F103: what they make on pins, by interrupts, by DMA and alone, to the tick.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr PinId kPA1{0, 1}, kPA6{0, 6}, kPA7{0, 7}, kPA8{0, 8}, kPB6{1, 6}, kPB13{1, 13};

using CortexMTimer = CortexM;

TEST_F(CortexMTimer, AThousandPulsesComeAtTheirPeriodAndThenNoMore) {
  const auto result = run("pulses", 20 * kMs);
  EXPECT_EQ(result.stop, Stop::kReached) << result.message;
  const auto rises = edgesOf(result.events, kPA0);
  EXPECT_THAT(rises, SizeIs(1000));
  EXPECT_THAT(steps(rises), Each(720U));
  const auto falls = edgesOf(result.events, kPA0, false);
  ASSERT_THAT(falls, SizeIs(1000));
  // Two stores of an instruction of one cycle and a wait of one cycle for the bus, and a constant between
  // them.
  for (std::size_t i = 0; i < falls.size(); ++i) EXPECT_EQ(falls[i] - rises[i], falls[0] - rises[0]);
  EXPECT_GE(falls[0] - rises[0], 2U);
  EXPECT_LE(falls[0] - rises[0], 6U);
}

TEST_F(CortexMTimer, AHundredThousandSysTicksHaveOnePeriod) {
  const auto result = run("systick", 1001 * kMs, 10 * kMs);
  std::vector<Tick> edges;
  for (const auto& event : result.events) edges.push_back(event.tick);
  ASSERT_GE(edges.size(), 100'000U);
  // An interrupt waits for the loop's branch to end, and no error adds up.
  for (std::size_t i = 0; i < edges.size(); ++i)
    EXPECT_LE(std::max(edges[i], edges[0] + i * 720) - std::min(edges[i], edges[0] + i * 720), 4U) << i;
}

TEST_F(CortexMTimer, OutputsOfTheTimersAloneAreExact) {
  const auto result = run("pwm", 20 * kMs);
  ASSERT_EQ(result.stop, Stop::kReached) << result.message;
  const auto periods = [&](PinId pin, Tick period, Tick high) {
    // The outputs were on before the timers ran: the first edge is the firmware's.
    auto rises = edgesOf(result.events, pin);
    auto falls = edgesOf(result.events, pin, false);
    ASSERT_GE(rises.size(), 900U);
    rises.erase(rises.begin());
    while (falls.front() < rises.front()) falls.erase(falls.begin());
    EXPECT_THAT(steps(rises), Each(period));
    EXPECT_EQ(falls.front() - rises.front(), high);
    EXPECT_THAT(steps(falls), Each(period));
  };
  periods(kPA6, 1000, 250);
  periods(kPA7, 1000, 900);   // 100 of 1000, inverted
  periods(kPA8, 1000, 200);   // centred: 2 * 100 of 2 * 500
  periods(kPB13, 1000, 800);  // the complement
  periods(kPB6, 1440, 720);   // toggled each 10 counts of 72 cycles
}

TEST_F(CortexMTimer, OnePulseIsOne) {
  const auto result = run("pwm", 20 * kMs);
  const auto rises = edgesOf(result.events, kPA1);
  const auto falls = edgesOf(result.events, kPA1, false);
  ASSERT_THAT(rises, SizeIs(1));
  ASSERT_THAT(falls, SizeIs(1));
  EXPECT_EQ(falls[0] - rises[0], 300U);
}

TEST_F(CortexMTimer, ANewDutyWaitsForTheNextPeriod) {
  const auto result = run("new_duty", 20 * kMs);
  const auto rises = edgesOf(result.events, kPA6);
  const auto falls = edgesOf(result.events, kPA6, false);
  std::map<Tick, int> widths;
  // The first level is there before the timer runs.
  for (std::size_t i = 1; i < std::min(rises.size(), falls.size()); ++i) ++widths[falls[i] - rises[i]];
  // What is written in a period's beginning holds from the next one on. 250: 11 periods, of which the first
  // began by hand; ten of 500; ten low; ten high that end with one of 250; then eight, and one in which it
  // stops.
  EXPECT_EQ(widths[500], 10);
  EXPECT_EQ(widths[10'250], 1);
  EXPECT_EQ(widths[250], 18);
  EXPECT_THAT(widths, SizeIs(3));
}

TEST_F(CortexMTimer, DmaMakesPulsesWithoutTheCore) {
  const auto result = run("timer_dma", 10 * kMs);
  EXPECT_EQ(result.stop, Stop::kReached) << result.message;
  std::vector<Tick> edges;
  for (const auto& event : result.events) edges.push_back(event.tick);
  EXPECT_GT(edges.size(), 1900U);
  EXPECT_THAT(steps(edges), Each(360U));
  EXPECT_THAT(steps(edgesOf(result.events, kPA1)), Each(1440U));
}

TEST_F(CortexMTimer, RepetitionsMakeEachFifthPeriodAnUpdate) {
  const auto result = run("tim1_repeat", 10 * kMs);
  std::vector<Tick> edges;
  for (const auto& event : result.events) edges.push_back(event.tick);
  EXPECT_GT(edges.size(), 140U);
  EXPECT_THAT(steps(edges), Each(5000U));
}

TEST_F(CortexMTimer, ACoreThatIsSlowerHasFewerCyclesInATick) {
  auto options = optionsFor("slow_clock");
  const auto result = runWith(options, 19 * kMs);
  ASSERT_EQ(result.stop, Stop::kReached) << result.message;
  const auto rises = edgesOf(result.events, kPA1);
  const auto falls = edgesOf(result.events, kPA1, false);
  ASSERT_GT(rises.size(), 1000U);
  std::vector<Tick> periods = steps(rises);
  periods.erase(periods.begin());
  EXPECT_THAT(periods, Each(900U));
  EXPECT_EQ(falls[5] - rises[5], 270U);
}

TEST_F(CortexMTimer, LoopsThatCountAndLoopsThatWaitTakeTheirTime) {
  const auto result = run("delay", 30 * kMs);
  std::vector<Tick> edges;
  for (const auto& event : result.events) edges.push_back(event.tick);
  const auto gaps = steps(edges);
  ASSERT_GT(gaps.size(), 30U);
  // A turn is SUBS 1 and a branch of 1 + P, P from 1 to 3; 999 of them are taken.
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_GE(gaps[i], 3000U) << i;
    EXPECT_LE(gaps[i], 5020U) << i;
  }
  for (std::size_t i = 10; i < gaps.size(); ++i)
    EXPECT_NEAR(static_cast<double>(gaps[i]), 72'000.0, 8.0) << i;
}

TEST_F(CortexMTimer, NothingDependsOnHowARunIsCut) {
  for (const char* firmware : {"delay", "pulses", "systick", "pwm", "timer_dma", "threads", "watchdog"}) {
    const auto whole = run(firmware, 4 * kMs, 4 * kMs);
    for (const Tick quantum : {Tick{1009}, Tick{7}}) {
      const Tick until = quantum == 7 ? kMs / 6 : 4 * kMs;
      auto cut = run(firmware, until, quantum);
      auto expected = whole.events;
      std::erase_if(expected, [&](const PinEvent& event) { return event.tick > until; });
      EXPECT_EQ(cut.events, expected) << firmware << " in quanta of " << quantum;
    }
  }
}

}  // namespace
}  // namespace kerfbench::source::cortex_m

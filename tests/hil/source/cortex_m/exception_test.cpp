// SPDX-License-Identifier: Apache-2.0
// Exceptions of the Cortex-M3: who comes first, what entry and return take, stacks, faults with a handler.
#include <gmock/gmock.h>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::ElementsAre;

using CortexMException = CortexM;

TEST_F(CortexMException, OrderFollowsPriorities) {
  // m: main; 2, 0, 1 by priority and number; EXTI2 nests (n) in EXTI1 before it goes on (b), and PendSV comes
  // last (p); SVC (s); under BASEPRI EXTI2 alone (2), main goes on (h), and then EXTI0.
  EXPECT_EQ(run("priorities", 20 * kMs).uart, "m201nbps2h0\n");
}

TEST_F(CortexMException, EntryTailChainingAndReturnTakeTheirCycles) {
  auto options = optionsFor("latency");
  options.clock_hz = 8'000'000;
  // Entry: STR 1, 12, LDR 2 and two pipelined 1 + 1. Tail-chaining: STR 1, 6 with the branch, LDR 2 + 1 + 1.
  // Return: STR 1, NOP 1, 12 with the branch, LDR 2.
  EXPECT_THAT(linesOf(runWith(options, 200'000).uart), ElementsAre("17", "11", "16"));
}

TEST_F(CortexMException, OneThatArrivesDuringAnEntryIsEnteredInstead) {
  const auto result = run("late_arrival", 10 * kMs);
  const auto steps_of_urgent = steps(edgesOf(result.events, {0, 1}));
  ASSERT_GT(steps_of_urgent.size(), 600U);
  // An entry that the other interrupt began three cycles before ends three cycles earlier than one of its
  // own; had it to wait for the other's end, it would be nine later.
  for (std::size_t i = 4; i < 600; ++i) {
    EXPECT_TRUE(steps_of_urgent[i] == 997 || steps_of_urgent[i] == 1003) << i << ": " << steps_of_urgent[i];
    EXPECT_EQ(steps_of_urgent[i] + steps_of_urgent[i - 1], 2000U) << i;
  }
  EXPECT_GT(result.events.size(), 2 * steps_of_urgent.size() + 300) << "the other one comes as well";
}

TEST_F(CortexMException, ThreadsHaveStacksOfTheirOwn) {
  EXPECT_THAT(linesOf(run("threads", 20 * kMs).uart), ElementsAre("1", "0", "15"));
}

TEST_F(CortexMException, FaultsComeToTheFirmwaresHandlerWithTheirCause) {
  // One by the handler of hard faults; then one by its own, with BFARVALID and PRECISERR (ARMv7-M, CFSR).
  EXPECT_THAT(linesOf(run("fault_handler", 20 * kMs).uart), ElementsAre("1", "2", "1", "33280"));
}

TEST_F(CortexMException, UsageFaultsAreToldApart) {
  // DIVBYZERO, UNALIGNED, INVSTATE and UNDEFINSTR are bits 25, 24, 17 and 16 of CFSR (ARMv7-M). Division, and
  // words of single loads, count only where CCR says so.
  EXPECT_THAT(linesOf(run("usage_faults", 20 * kMs).uart),
              ElementsAre("0", "0", "16777216", "65536", "131072", "33554432", "16777216"));
}

TEST_F(CortexMException, TheWatchdogResetsAfterItsTime) {
  const auto result = run("watchdog", 100 * kMs);
  EXPECT_EQ(result.uart, "watchdog\n");
  const auto rises = edgesOf(result.events, kPA0);
  const auto falls = edgesOf(result.events, kPA0, false);
  ASSERT_EQ(rises.size(), 1U);
  ASSERT_EQ(falls.size(), 1U);
  // Fed ten times, each 5 ms; then 100 counts of 4 clocks of 40 kHz, that is 10 ms, and a reset of 20 us.
  EXPECT_NEAR(static_cast<double>(falls[0] - rises[0]) / kMs, 45.0 + 10.0 + 0.02, 0.05);
}

}  // namespace
}  // namespace kerfbench::source::cortex_m

// SPDX-License-Identifier: Apache-2.0
// Interrupts by the words of the MCS-51 user's manual (Intel 1994): what is polled when, priorities, and the
// instruction that goes before.
#include <gmock/gmock.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

/// Timer 0 in mode 2 with a period of 100 machine cycles; its interrupt inverts P1.0.
Program ticking(unsigned nops_in_service = 0) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).nop(nops_in_service).reti().at(0x40);
  p.mov(kTmod, 0x02).mov(kTl0, 156).mov(kTh0, 156).mov(kIe, 0x82).setb(kTr0);
  return p;
}

TEST(Mcs51Interrupts, ATimerInterruptsALoopOfTwoCyclesAtTheEndOfAJump) {
  // LJMP, four MOVs and SETB are 11 cycles. The timer counts from cycle 11 on and overflows in cycle 110; the
  // flag, set in its S5P2, is polled in cycle 111. SJMP has the cycles 109 and 110, and 111 and 112: the
  // latter is interrupted at its end by what was flagged before 112. The call has 113 and 114, CPL 115; the
  // pin changes at the begin of 116.
  Program even = ticking(1);
  even.halt();
  Bench bench("at89c52", even);
  const auto ticks = changesOf(bench.runTo(12 * 10'000), 1, 0);
  ASSERT_GT(ticks.size(), 90U);
  EXPECT_EQ(ticks[0], 12U * 116);
  // Call, CPL, NOP and RETI are six cycles, so that jumps always begin in odd ones.
  EXPECT_THAT(stepsOf(ticks), Each(100U));
  // Without the NOP they are five, and the jumps begin in odd and even cycles by turns.
  Program odd = ticking();
  odd.halt();
  Bench other("at89c52", odd);
  const auto steps = stepsOf(changesOf(other.runTo(12 * 10'000), 1, 0));
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i], i % 2 == 0 ? 99U : 101U);
}

TEST(Mcs51Interrupts, AFlagInTheLastCycleOfAnInstructionWaitsForTheNextOne) {
  // NOPs have one cycle: the flag of cycle 110 is polled in 111, and the call has 112 and 113.
  Program p = ticking();
  p.nop(150).halt();
  Bench bench("at89c52", p);
  EXPECT_EQ(changesOf(bench.runTo(12 * 130), 1, 0).front(), 12U * 115);
  // A MUL in cycles 107 to 110 ends in the cycle of the flag, so that one NOP comes first.
  Program q = ticking();
  q.nop(96).put({0xA4}).nop(50).halt();
  Bench late("at89c52", q);
  EXPECT_EQ(changesOf(late.runTo(12 * 130), 1, 0).front(), 12U * 115);
  // A MUL in cycles 111 to 114 is not broken off: the call has 115 and 116.
  Program r = ticking();
  r.nop(100).put({0xA4}).nop(50).halt();
  Bench later("at89c52", r);
  EXPECT_EQ(changesOf(later.runTo(12 * 130), 1, 0).front(), 12U * 118);
}

TEST(Mcs51Interrupts, Timer2IsPolledInTheCycleOfItsOverflow) {
  Program p;
  p.ljmp(0x40).at(0x2B).cpl(kP1_0).clr(kTf2Bit).reti().at(0x40);
  p.mov(kRcap2l, 156).mov(kRcap2h, 255).mov(kTl2, 156).mov(kTh2, 255).mov(kIe, 0xA0).setb(kTr2Bit).nop(150);
  Bench bench("at89c52", p);
  // 13 cycles until SETB; the overflow is in cycle 112 and polled there. The call has 113 and 114, CPL 115.
  EXPECT_EQ(changesOf(bench.runTo(12 * 130), 1, 0).front(), 12U * 116);
}

TEST(Mcs51Interrupts, AWriteToTheEnablesLetsOneMoreInstructionRun) {
  // The flag is up for long when EA is set; INC R7 runs before the call, the one behind it does not.
  Program p;
  p.ljmp(0x40).at(0x0B).put({0x8F, 0x30}).halt();  // MOV 30,R7
  p.at(0x40).mov(kIe, 0x02).setb(kTf0).nop(5).setb(kEaBit).put({0x0F, 0x0F, 0x0F}).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 100);
  EXPECT_EQ(bench.ram(0x30), 1);
  // The same with IP, which is written while everything is enabled: two instructions after the flag.
  Program q;
  q.ljmp(0x40).at(0x0B).put({0x8F, 0x30}).halt();
  q.at(0x40).mov(kIe, 0x82).setb(kTf0).mov(kIp, 0x02).put({0x0F, 0x0F, 0x0F}).halt();
  Bench other("at89c51", q);
  other.runTo(12 * 100);
  EXPECT_EQ(other.ram(0x30), 1);
}

TEST(Mcs51Interrupts, OneInstructionRunsBetweenReturnAndTheNextCall) {
  // The flag of timer 0 is set anew inside of its service: between two calls INC R7 runs once. Before the
  // first one it runs twice: what SETB writes is sampled in the next cycle, and polled in the one after.
  Program p;
  p.ljmp(0x40).at(0x0B).ljmp(0x60);
  p.at(0x40).mov(kIe, 0x82).setb(kTf0);
  for (int i = 0; i < 12; ++i) p.put({0x0F});
  p.halt();
  p.at(0x60).put({0xEF, 0xF6, 0x08}).setb(kTf0).reti();  // MOV A,R7; MOV @R0,A; INC R0
  p.at(0).put({0x02, 0x00, 0x38}).at(0x38).put({0x78, 0x30}).ljmp(0x40);
  Bench bench("at89c51", p);
  bench.runTo(12 * 120);
  for (std::uint8_t i = 0; i < 5; ++i) EXPECT_EQ(bench.ram(static_cast<std::uint8_t>(0x30 + i)), 2 + i);
}

TEST(Mcs51Interrupts, ThePollingOrderDecidesAmongEqualsAndThePriorityBeforeIt) {
  const auto order = [](unsigned priorities) {
    Program p;
    p.ljmp(0x40);
    const auto service = [&](unsigned vector, unsigned mark, std::uint8_t flag) {
      p.at(vector).ljmp(0x80 + 16 * mark);
      p.at(0x80 + 16 * mark).put({0x76, mark, 0x08});  // MOV @R0,#mark; INC R0
      if (flag != 0) p.clr(flag);
      p.reti();
    };
    service(0x03, 1, 0);
    service(0x0B, 2, 0);
    service(0x13, 3, 0);
    service(0x1B, 4, 0);
    service(0x23, 5, kTiBit);
    service(0x2B, 6, kTf2Bit);
    p.at(0x40).put({0x78, 0x30}).mov(kIp, priorities).mov(kT2con, 0x80).mov(kScon, 0x02);
    p.mov(kTcon, 0xAF).mov(kIe, 0xBF).nop(20).halt();  // All flags, INT0 and INT1 by edges.
    Bench bench("at89c52", p);
    bench.runTo(12 * 200);
    std::vector<int> marks;
    for (std::uint8_t i = 0; i < 6; ++i) marks.push_back(bench.ram(static_cast<std::uint8_t>(0x30 + i)));
    return marks;
  };
  EXPECT_THAT(order(0x00), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(order(0x28), ElementsAre(4, 6, 1, 2, 3, 5));
  EXPECT_THAT(order(0x3F), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Mcs51Interrupts, AHighPriorityBreaksIntoALowOneAndNotTheOtherWayRound) {
  // Each service sets its bit of P1 low, asks for the other interrupt, waits, and sets it high.
  const auto nested = [](unsigned priorities) {
    Program p;
    p.ljmp(0x40).at(0x0B).ljmp(0x80).at(0x1B).ljmp(0xA0);
    p.at(0x40).mov(kIp, priorities).mov(kIe, 0x8A).setb(kTf0).nop(4).halt();
    p.at(0x80).clr(kP1_0).setb(kTf1).nop(5).setb(kP1_0).reti();
    p.at(0xA0).clr(kP1_1).nop(5).setb(kP1_1).reti();
    Bench bench("at89c51", p);
    std::vector<unsigned> levels;
    for (const auto& event : bench.runTo(12 * 200)) levels.push_back(event.level & 3U);
    return levels;
  };
  EXPECT_THAT(nested(0x08), ElementsAre(2, 0, 2, 3));  // Timer 1 inside of timer 0.
  EXPECT_THAT(nested(0x00), ElementsAre(2, 3, 1, 3));  // One after the other.
  EXPECT_THAT(nested(0x0A), ElementsAre(2, 3, 1, 3));
  EXPECT_THAT(nested(0x02), ElementsAre(2, 3, 1, 3));
}

TEST(Mcs51Interrupts, AnEdgeIsTakenOnceAndALevelAsLongAsItLasts) {
  const auto services = [](bool by_edge) {
    Program p;
    p.ljmp(0x40).at(0x03).put({0x0F}).reti().at(0x40);  // INC R7
    if (by_edge) p.setb(kIt0);
    p.mov(kIe, 0x81).halt();
    Bench bench("at89c51", p);
    bench.runTo(12 * 100);
    bench.chip().drive(3, 2, false, bench.chip().now() + 1);
    bench.runTo(12 * 200);
    bench.chip().drive(3, 2, true, bench.chip().now() + 1);
    bench.runTo(12 * 300);
    return static_cast<int>(bench.ram(7));
  };
  EXPECT_EQ(services(true), 1);
  EXPECT_GT(services(false), 10);
}

TEST(Mcs51Interrupts, AnExternalRequestWaitsAtLeastThreeCycles) {
  // INT0 falls before S5P2 of a NOP's cycle: polled in the next one, call in the two after it.
  Program p;
  p.ljmp(0x40).at(0x03).cpl(kP1_0).reti();
  p.at(0x40).setb(kIt0).mov(kIe, 0x81).nop(100).halt();
  for (const Tick inside : {Tick{0}, Tick{9}, Tick{10}}) {
    Bench bench("at89c51", p);
    bench.runTo(12 * 20);
    bench.chip().drive(3, 2, false, 12 * 20 + inside);
    const Tick sampled = inside <= 9 ? 20 : 21;
    EXPECT_EQ(changesOf(bench.runTo(12 * 40), 1, 0).front(), 12 * (sampled + 1 + 1 + 2 + 1)) << inside;
  }
}

TEST(Mcs51Interrupts, APulseBetweenTwoSamplesIsNotSeen) {
  Program p;
  p.ljmp(0x40).at(0x03).put({0x0F}).reti();
  p.at(0x40).setb(kIt0).mov(kIe, 0x81).nop(100).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 20);
  bench.chip().drive(3, 2, false, 12 * 20 + 10);
  bench.chip().drive(3, 2, true, 12 * 20 + 21);
  bench.runTo(12 * 40);
  EXPECT_EQ(bench.ram(7), 0);
  bench.chip().drive(3, 2, false, 12 * 40 + 10);
  bench.chip().drive(3, 2, true, 12 * 40 + 22);
  bench.runTo(12 * 60);
  EXPECT_EQ(bench.ram(7), 1);
}

TEST(Mcs51Interrupts, AFlagThatIsTakenBackBeforeItIsPolledIsForgotten) {
  Program p;
  p.ljmp(0x40).at(0x0B).put({0x0F}).reti();
  p.at(0x40).setb(kTf0).nop(3).clr(kTf0).mov(kIe, 0x82).nop(10).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 100);
  EXPECT_EQ(bench.ram(7), 0);
}

TEST(Mcs51Interrupts, IdleEndsWithAnInterruptAndGoesOnBehindIt) {
  Program p = ticking();
  const unsigned loop = p.here();
  p.put({0x43, kPcon, 0x01}).cpl(kP1_1).sjmp(loop);  // ORL PCON,#IDL
  Bench bench("at89c52", p);
  const auto events = bench.runTo(12 * 2000);
  const auto services = changesOf(events, 1, 0);
  const auto wakes = changesOf(events, 1, 1);
  ASSERT_GE(services.size(), 18U);
  // The overflow of cycle 110 is polled in 111, where nothing else is to be finished.
  EXPECT_EQ(services[0], 12U * 115);
  EXPECT_THAT(stepsOf(services), Each(100U));
  ASSERT_GE(wakes.size(), 18U);
  for (std::size_t i = 0; i < wakes.size(); ++i) EXPECT_EQ(wakes[i] - services[i], 12U * 3);  // RETI, CPL
}

TEST(Mcs51Interrupts, IdleWithInterruptsOffIsTheEnd) {
  Program p;
  p.mov(kPcon, 0x01).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 100);
  EXPECT_THAT(bench.chip().end(), ::testing::HasSubstr("nothing can wake it"));
}

TEST(Mcs51Interrupts, PowerDownEndsByInt0WhereThePartHasThat) {
  Program p;
  p.ljmp(0x40).at(0x03).cpl(kP1_0).mov(kIe, 0).reti();
  p.at(0x40).mov(kTmod, 0x01).setb(kTr0).mov(kIe, 0x81).mov(kPcon, 0x02).movDirect(0x30, kTl0).halt();
  Bench bench("at89s52", p);
  bench.runTo(12 * 1000);
  EXPECT_TRUE(bench.chip().end().empty());
  bench.chip().drive(3, 2, false, bench.chip().now());
  EXPECT_EQ(changesOf(bench.runTo(12 * 1100), 1, 0).size(), 1U);
  EXPECT_LT(bench.ram(0x30), 30);  // The timer stood meanwhile.
  Bench plain("at89c52", p);
  plain.runTo(12 * 100);
  EXPECT_THAT(plain.chip().end(), ::testing::HasSubstr("power-down"));
}

}  // namespace
}  // namespace kerfbench::mcs51_child

// SPDX-License-Identifier: Apache-2.0
// Timers in all their modes, by the words of the MCS-51 user's manual (Intel 1994).
#include <gmock/gmock.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::Each;

/// Runs a timer from a low and a high byte; P1.0 is inverted in each interrupt. Cycles between two of them.
std::vector<Tick> periods(std::string_view part, unsigned timer, unsigned tmod, unsigned low, unsigned high) {
  Program p;
  p.ljmp(0x40).at(timer == 0 ? 0x0B : 0x1B).cpl(kP1_0).nop().reti().at(0x40);
  p.mov(kTmod, tmod).mov(timer == 0 ? kTl0 : kTl1, low).mov(timer == 0 ? kTh0 : kTh1, high);
  p.mov(kIe, timer == 0 ? 0x82 : 0x88).setb(timer == 0 ? kTr0 : kTr1).halt();
  Bench bench(part, p);
  const auto ticks = changesOf(bench.runTo(12 * 400'000), 1, 0);
  std::vector<Tick> all = stepsOf(ticks);
  all.insert(all.begin(), ticks.empty() ? 0 : ticks[0] / 12);
  return all;
}

TEST(Mcs51Timers, HaveThirteenBitsInMode0) {
  for (unsigned timer : {0U, 1U}) {
    const auto cycles = periods("at89c51", timer, 0x00, 0x1F, 0xFE);
    // FE, 1F are 8159 of 8192.
    EXPECT_NEAR(static_cast<double>(cycles[0]), 11 + 33 + 5, 2);
    EXPECT_EQ(std::vector<Tick>(cycles.begin() + 1, cycles.begin() + 10), std::vector<Tick>(9, 8192));
  }
}

TEST(Mcs51Timers, HaveSixteenBitsInMode1) {
  for (unsigned timer : {0U, 1U}) {
    const auto cycles = periods("at89c51", timer, timer == 0 ? 0x01 : 0x10, 0x00, 0xFF);
    EXPECT_NEAR(static_cast<double>(cycles[0]), 11 + 256 + 5, 2);
    ASSERT_GE(cycles.size(), 5U);
    for (std::size_t i = 1; i < cycles.size(); ++i) EXPECT_EQ(cycles[i], 65536U);
  }
}

TEST(Mcs51Timers, ReloadInMode2) {
  for (unsigned timer : {0U, 1U}) {
    const auto cycles = periods("at89c51", timer, timer == 0 ? 0x02 : 0x20, 0x00, 0xC0);
    EXPECT_NEAR(static_cast<double>(cycles[0]), 11 + 256 + 5, 2);
    EXPECT_THAT(std::vector<Tick>(cycles.begin() + 1, cycles.end()), Each(64U));
  }
}

TEST(Mcs51Timers, Timer0IsTwoTimersInMode3AndTimer1RunsWithoutItsFlag) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).reti().at(0x1B).cpl(kP1_1).reti().at(0x40);
  p.mov(kTmod, 0x23).mov(kTl1, 0).mov(kTh1, 0).mov(kIe, 0x8A).setb(kTr0).setb(kTr1).nop(100);
  p.movDirect(0x30, kTl1);  // Timer 1 has run since TMOD was written.
  p.clr(kTr1).nop(50).movDirect(0x31, kTl1).mov(kTmod, 0x33).movDirect(0x32, kTl1).nop(20);
  p.movDirect(0x33, kTl1).halt();
  Bench bench("at89c51", p);
  const auto events = bench.runTo(12 * 5000);
  const auto tl0 = stepsOf(changesOf(events, 1, 0));
  ASSERT_GT(tl0.size(), 10U);
  for (const Tick step : tl0) EXPECT_NEAR(static_cast<double>(step), 256, 6);
  EXPECT_EQ(changesOf(events, 1, 1).size(), 0U);     // TR1, which TH0 obeys, is cleared before it overflows.
  EXPECT_EQ(bench.ram(0x31) - bench.ram(0x30), 53);  // TR1 does not stop timer 1.
  EXPECT_EQ(bench.ram(0x33), bench.ram(0x32));       // Mode 3 does.
}

TEST(Mcs51Timers, Th0InMode3FlagsForTimer1) {
  Program p;
  p.ljmp(0x40).at(0x1B).cpl(kP1_1).reti().at(0x40);
  p.mov(kTmod, 0x03).mov(kTh0, 200).mov(kIe, 0x88).setb(kTr1).halt();
  Bench bench("at89c51", p);
  const auto ticks = changesOf(bench.runTo(12 * 3000), 1, 1);
  ASSERT_GE(ticks.size(), 10U);
  EXPECT_NEAR(static_cast<double>(ticks[0]) / 12, 9 + 56 + 5, 2);
  for (const Tick step : stepsOf(ticks)) EXPECT_NEAR(static_cast<double>(step), 256, 2);
}

TEST(Mcs51Timers, CountAsSoonAsTheCycleBehindTheWriteThatStartsThem) {
  // MOV A,TL0 reads behind the counting of its own cycle: one cycle behind SETB it finds 1.
  Program p;
  p.mov(kTmod, 0x01).setb(kTr0).put({0xE5, kTl0, 0xF5, 0x30}).put({0xE5, kTl0, 0xF5, 0x31}).clr(kTr0);
  p.movDirect(0x32, kTl0).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 50);
  EXPECT_EQ(bench.ram(0x30), 1);
  EXPECT_EQ(bench.ram(0x31), 3);
  EXPECT_EQ(bench.ram(0x32), 5);  // From SETB to CLR there are five cycles, the one of CLR with them.
}

TEST(Mcs51Timers, StandWhileTheGateIsLow) {
  Program p;
  p.mov(kTmod, 0x09).setb(kTr0).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 100);
  bench.chip().drive(3, 2, false, bench.chip().now());
  bench.runTo(12 * 200);
  const unsigned held = bench.chip().peekSfr(kTl0);
  bench.runTo(12 * 250);
  EXPECT_EQ(bench.chip().peekSfr(kTl0), held);
  EXPECT_NEAR(held, 100 - 3, 2);
  bench.chip().drive(3, 2, true, bench.chip().now());
  bench.runTo(12 * 300);
  EXPECT_NEAR(bench.chip().peekSfr(kTl0), held + 50U, 2);
}

TEST(Mcs51Timers, CountFallingEdgesOfTheirPins) {
  for (const unsigned timer : {0U, 1U}) {
    Program p;
    p.mov(kTmod, timer == 0 ? 0x05 : 0x50).setb(timer == 0 ? kTr0 : kTr1).halt();
    Bench bench("at89c51", p);
    bench.runTo(12 * 10);
    for (int i = 0; i < 7; ++i) {
      bench.chip().drive(3, 4 + timer, false, bench.chip().now());
      bench.runTo(bench.chip().now() + 36);
      bench.chip().drive(3, 4 + timer, true, bench.chip().now());
      bench.runTo(bench.chip().now() + 36);
    }
    EXPECT_EQ(bench.chip().peekSfr(timer == 0 ? kTl0 : kTl1), 7) << timer;
  }
}

TEST(Mcs51Timers, CountWhatTheFirmwareWritesToTheirPin) {
  Program p;
  p.mov(kTmod, 0x05).setb(kTr0);
  for (int i = 0; i < 4; ++i) p.clr(kP3_4).nop(2).setb(kP3_4).nop(2);
  p.halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 100);
  EXPECT_EQ(bench.chip().peekSfr(kTl0), 4);
}

TEST(Mcs51Timers, Timer2ReloadsSixteenBits) {
  Program p;
  p.ljmp(0x40).at(0x2B).cpl(kP1_3).clr(kTf2Bit).reti().at(0x40);
  p.mov(kRcap2l, 0x18).mov(kRcap2h, 0xFC).mov(kTl2, 0x18).mov(kTh2, 0xFC).mov(kIe, 0xA0).setb(kTr2Bit);
  p.halt();
  Bench bench("80c52", p);
  const auto ticks = changesOf(bench.runTo(12 * 50'000), 1, 3);
  ASSERT_GT(ticks.size(), 40U);
  EXPECT_EQ(stepsOf(ticks), std::vector<Tick>(ticks.size() - 1, 1000));
}

TEST(Mcs51Timers, Timer2CapturesAtT2ex) {
  Program p;
  p.mov(kT2con, kExen2 | kTr2 | kCapture2).halt();
  Bench bench("at89c52", p);
  bench.runTo(12 * 1000);
  bench.chip().drive(1, 1, false, 12 * 1000);
  bench.runTo(12 * 1010);
  const unsigned captured = bench.chip().peekSfr(kRcap2h) * 256U + bench.chip().peekSfr(kRcap2l);
  EXPECT_NEAR(captured, 1000 - 2 + 1, 1);
  EXPECT_NE(bench.chip().peekSfr(kT2con) & kExf2, 0);
  bench.chip().drive(1, 1, true, 12 * 1010);
  bench.runTo(12 * 66'500);
  EXPECT_NE(bench.chip().peekSfr(kT2con) & kTf2, 0);
  // Behind 65 536 it went on from zero: nothing was reloaded.
  EXPECT_NEAR(bench.chip().peekSfr(kTh2) * 256U + bench.chip().peekSfr(kTl2), 66'500 - 65'536 - 2, 4);
}

TEST(Mcs51Timers, T2exReloadsTimer2WhereItDoesNotCapture) {
  Program p;
  p.mov(kRcap2h, 0x80).mov(kT2con, kExen2 | kTr2).halt();
  Bench bench("at89c52", p);
  bench.runTo(12 * 1000);
  bench.chip().drive(1, 1, false, 12 * 1000);
  bench.runTo(12 * 1020);
  EXPECT_EQ(bench.chip().peekSfr(kTh2), 0x80);
  EXPECT_NE(bench.chip().peekSfr(kT2con) & kExf2, 0);
}

TEST(Mcs51Timers, Timer2PutsAClockOutWhereThePartHasThat) {
  Program p;
  p.mov(kRcap2l, 0xF6)
      .mov(kRcap2h, 0xFF)
      .mov(kTl2, 0xF6)
      .mov(kTh2, 0xFF)
      .mov(kT2mod, kT2oe)
      .mov(kT2con, kTr2)
      .halt();
  Bench bench("at89s52", p);
  const auto ticks = changesOf(bench.runTo(100'000), 1, 0);
  ASSERT_GT(ticks.size(), 1000U);
  // Atmel 2008: f/(4 (65536 - RCAP2)), so that half a period is 20 clocks.
  const auto steps = stepsOf(ticks, 1);
  EXPECT_EQ(std::vector<Tick>(steps.begin() + 1, steps.end()), std::vector<Tick>(steps.size() - 1, 20));
  Bench plain("80c52", p);
  EXPECT_TRUE(changesOf(plain.runTo(100'000), 1, 0).empty());
}

TEST(Mcs51Timers, CountingDownIsRefusedInWords) {
  Program p;
  p.mov(kT2mod, kDcen).halt();
  Bench bench("at89s52", p);
  bench.runTo(1000);
  EXPECT_THAT(bench.chip().fault(), ::testing::HasSubstr("DCEN"));
}

TEST(Mcs51Timers, TheWatchdogOfTheAt89s52ResetsUnlessItIsFed) {
  Program p;
  p.clr(kP1_0).mov(kWdtrst, 0x1E).mov(kWdtrst, 0xE1).halt();
  Bench bench("at89s52", p);
  const auto events = bench.runTo(12 * 50'000);
  const auto ticks = changesOf(events, 1, 0);
  // CLR, reset, CLR: 16383 cycles from the second write to WDTRST, and 98 clocks of reset.
  ASSERT_GE(ticks.size(), 5U);
  EXPECT_NEAR(static_cast<double>(ticks[1] - ticks[0]), 12.0 * (4 + 16383), 24);
  EXPECT_NEAR(static_cast<double>(ticks[2] - ticks[1]), 98 + 12, 24);
  Program fed;
  fed.mov(kWdtrst, 0x1E).mov(kWdtrst, 0xE1);
  const unsigned loop = fed.here();
  fed.cpl(kP1_0).mov(kWdtrst, 0x1E).mov(kWdtrst, 0xE1).sjmp(loop);
  Bench other("at89s52", fed);
  EXPECT_THAT(stepsOf(changesOf(other.runTo(12 * 50'000), 1, 0)), Each(7U));
}

}  // namespace
}  // namespace kerfbench::mcs51_child

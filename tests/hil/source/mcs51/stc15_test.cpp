// SPDX-License-Identifier: Apache-2.0
// A controller with one clock a machine cycle, by its data sheet (STC 2015).
#include <gmock/gmock.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::Each;

constexpr std::string_view kPart = "stc15f2k60s2";

/// Clocks between two changes of P1.0 with an instruction between them, less what the second change takes.
Tick clocksOf(std::initializer_list<unsigned> instruction) {
  Program p;
  p.at(0).nop(4).cpl(kP1_0).put(instruction).cpl(kP1_0).halt();
  Bench bench(kPart, p);
  const auto ticks = changesOf(bench.runTo(100), 1, 0);
  return ticks.at(1) - ticks.at(0) - 3;
}

TEST(Stc15Clocks, OfEachClassOfInstructionsAreThoseOfTheTable) {
  EXPECT_EQ(clocksOf({0x00}), 1U);              // NOP
  EXPECT_EQ(clocksOf({0x28}), 1U);              // ADD A,R0
  EXPECT_EQ(clocksOf({0x25, 0x30}), 2U);        // ADD A,direct
  EXPECT_EQ(clocksOf({0x26}), 2U);              // ADD A,@R0
  EXPECT_EQ(clocksOf({0x94, 0x01}), 2U);        // SUBB A,#
  EXPECT_EQ(clocksOf({0x04}), 1U);              // INC A
  EXPECT_EQ(clocksOf({0x08}), 2U);              // INC R0
  EXPECT_EQ(clocksOf({0x05, 0x30}), 3U);        // INC direct
  EXPECT_EQ(clocksOf({0x16}), 3U);              // DEC @R0
  EXPECT_EQ(clocksOf({0xA3}), 1U);              // INC DPTR
  EXPECT_EQ(clocksOf({0xA4}), 2U);              // MUL
  EXPECT_EQ(clocksOf({0x84}), 6U);              // DIV
  EXPECT_EQ(clocksOf({0xD4}), 3U);              // DA
  EXPECT_EQ(clocksOf({0x42, 0x30}), 3U);        // ORL direct,A
  EXPECT_EQ(clocksOf({0x53, 0x30, 0x0F}), 3U);  // ANL direct,#
  EXPECT_EQ(clocksOf({0x33}), 1U);              // RLC
  EXPECT_EQ(clocksOf({0xC4}), 1U);              // SWAP
  EXPECT_EQ(clocksOf({0xE8}), 1U);              // MOV A,R0
  EXPECT_EQ(clocksOf({0xA8, 0x30}), 3U);        // MOV R0,direct
  EXPECT_EQ(clocksOf({0x88, 0x30}), 2U);        // MOV direct,R0
  EXPECT_EQ(clocksOf({0x85, 0x30, 0x31}), 3U);  // MOV direct,direct
  EXPECT_EQ(clocksOf({0x90, 0x00, 0x00}), 3U);  // MOV DPTR,#
  EXPECT_EQ(clocksOf({0x93}), 5U);              // MOVC A,@A+DPTR
  EXPECT_EQ(clocksOf({0x83}), 4U);              // MOVC A,@A+PC
  EXPECT_EQ(clocksOf({0xE0}), 2U);              // MOVX A,@DPTR
  EXPECT_EQ(clocksOf({0xF0}), 3U);              // MOVX @DPTR,A
  EXPECT_EQ(clocksOf({0xE2}), 3U);              // MOVX A,@R0
  EXPECT_EQ(clocksOf({0xF3}), 4U);              // MOVX @R1,A
  EXPECT_EQ(clocksOf({0xC0, 0x30}), 3U);        // PUSH
  EXPECT_EQ(clocksOf({0xD0, 0x30}), 2U);        // POP
  EXPECT_EQ(clocksOf({0xC8}), 2U);              // XCH A,R0
  EXPECT_EQ(clocksOf({0xD6}), 3U);              // XCHD
  EXPECT_EQ(clocksOf({0xC3}), 1U);              // CLR C
  EXPECT_EQ(clocksOf({0xD2, 0x08}), 3U);        // SETB bit
  EXPECT_EQ(clocksOf({0xA2, 0x08}), 2U);        // MOV C,bit
  EXPECT_EQ(clocksOf({0x92, 0x08}), 3U);        // MOV bit,C
  EXPECT_EQ(clocksOf({0x82, 0x08}), 2U);        // ANL C,bit
  EXPECT_EQ(clocksOf({0x40, 0x00}), 3U);        // JC
  EXPECT_EQ(clocksOf({0x60, 0x00}), 4U);        // JZ
  EXPECT_EQ(clocksOf({0x20, 0x08, 0x00}), 5U);  // JB
  EXPECT_EQ(clocksOf({0x10, 0x08, 0x00}), 5U);  // JBC
  EXPECT_EQ(clocksOf({0x80, 0x00}), 3U);        // SJMP
  EXPECT_EQ(clocksOf({0xB4, 0x00, 0x00}), 4U);  // CJNE A,#
  EXPECT_EQ(clocksOf({0xB5, 0x30, 0x00}), 5U);  // CJNE A,direct
  EXPECT_EQ(clocksOf({0xB6, 0x30, 0x00}), 5U);  // CJNE @R0,#
  EXPECT_EQ(clocksOf({0xD8, 0x00}), 4U);        // DJNZ R0
  EXPECT_EQ(clocksOf({0xD5, 0x30, 0x00}), 5U);  // DJNZ direct
  EXPECT_EQ(clocksOf({0x02, 0x00, 0x09}), 4U);  // LJMP to the next instruction
  EXPECT_EQ(clocksOf({0x01, 0x08}), 3U);        // AJMP
  EXPECT_EQ(clocksOf({0x12, 0x00, 0x09}), 4U);  // LCALL
  EXPECT_EQ(clocksOf({0x11, 0x08}), 4U);        // ACALL
}

TEST(Stc15Clocks, OfReturnsAreFour) {
  for (const unsigned opcode : {0x22U, 0x32U}) {
    Program p;
    p.ljmp(0x20).at(0x10).put({opcode}).at(0x20);
    p.cpl(kP1_0).put({0x12, 0x00, 0x10}).cpl(kP1_0).halt();
    Bench bench(kPart, p);
    const auto ticks = changesOf(bench.runTo(100), 1, 0);
    ASSERT_EQ(ticks.size(), 2U);
    EXPECT_EQ(ticks[1] - ticks[0], 4U + 4 + 3);
  }
}

std::vector<Tick> timerSteps(unsigned auxr, unsigned tmod, Tick until = 100'000) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).reti().at(0x40);
  p.mov(kAuxr, auxr).mov(kTmod, tmod).mov(kTl0, 0x9C).mov(kTh0, tmod == 2 ? 0x9C : 0xFF).mov(kIe, 0x82);
  p.setb(kTr0);
  const unsigned loop = p.here();
  for (int i = 0; i < 100; ++i) p.nop();
  p.ljmp(loop);
  Bench bench(kPart, p);
  return stepsOf(changesOf(bench.runTo(until), 1, 0), 1);
}

TEST(Stc15Timers, ReloadSixteenBitsInMode0AndCountClocksWhereAuxrSaysSo) {
  double sum = 0;
  const auto fast = timerSteps(0x80, 0);
  ASSERT_GT(fast.size(), 900U);
  for (const Tick step : fast) sum += static_cast<double>(step);
  EXPECT_NEAR(sum / static_cast<double>(fast.size()), 100.0, 0.01);
  EXPECT_THAT(fast, Each(testing::AllOf(testing::Ge(97U), testing::Le(103U))));
  sum = 0;
  const auto slow = timerSteps(0x00, 0);
  ASSERT_GT(slow.size(), 70U);
  for (const Tick step : slow) sum += static_cast<double>(step);
  EXPECT_NEAR(sum / static_cast<double>(slow.size()), 1200.0, 0.1);
}

TEST(Stc15Timers, ReloadEightBitsInMode2) {
  double sum = 0;
  const auto steps = timerSteps(0x80, 2);
  ASSERT_GT(steps.size(), 900U);
  for (const Tick step : steps) sum += static_cast<double>(step);
  EXPECT_NEAR(sum / static_cast<double>(steps.size()), 100.0, 0.01);
}

TEST(Stc15Timers, TakeAReloadValueThatIsWrittenWhileTheyRunWithTheNextOverflow) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).reti().at(0x40);
  p.mov(kAuxr, 0x80).mov(kTl0, 0x18).mov(kTh0, 0xFC).mov(kIe, 0x82).setb(kTr0);  // 1000
  p.mov(kTh0, 0xFE);                                                             // 488 from then on
  const unsigned loop = p.here();
  p.nop(4).ljmp(loop);
  Bench bench(kPart, p);
  const auto ticks = changesOf(bench.runTo(5000), 1, 0);
  ASSERT_GE(ticks.size(), 3U);
  EXPECT_NEAR(static_cast<double>(ticks[0]), 3 + 4 + 9 + 3 + 3 + 1000, 15);
  EXPECT_NEAR(static_cast<double>(ticks[1] - ticks[0]), 488, 6);
}

TEST(Stc15Timers, Timer2InterruptsAtVector63) {
  Program p;
  p.ljmp(0x80).at(0x63).cpl(kP1_0).reti().at(0x80);
  p.mov(kStcT2l, 0x18).mov(kStcT2h, 0xFC).mov(kIe2, 0x04).mov(kIe, 0x80).mov(kAuxr, 0x15);
  const unsigned loop = p.here();
  p.nop(4).ljmp(loop);
  Bench bench(kPart, p);
  const auto steps = stepsOf(changesOf(bench.runTo(50'000), 1, 0), 1);
  ASSERT_GT(steps.size(), 40U);
  for (const Tick step : steps) EXPECT_NEAR(static_cast<double>(step), 1000, 5);
}

TEST(Stc15Uart, TakesItsRateFromTimer2OrTimer1) {
  // Baud = clock/(4 (65536 - reload)).
  for (const bool by_timer2 : {true, false}) {
    Program p;
    if (by_timer2) {
      p.mov(kStcT2l, 0x98).mov(kStcT2h, 0xFF).mov(kAuxr, 0x15);
    } else {
      p.mov(kTl1, 0x98).mov(kTh1, 0xFF).mov(kAuxr, 0x40).setb(kTr1);
    }
    p.mov(kScon, 0x40);
    const unsigned loop = p.here();
    p.mov(kSbuf, 0x41).put({0x30, kTiBit, 0xFD}).clr(kTiBit).sjmp(loop);
    Bench bench(kPart, p);
    bench.runTo(100'000);
    const auto frames = bench.chip().uart().takeSent();
    ASSERT_GT(frames.size(), 20U);
    EXPECT_EQ(frames[1].begins - frames[0].begins, 10U * 4 * 104) << by_timer2;
  }
}

// The reference controller hung when a flag that hardware set between read and write of CLR was lost.
TEST(Stc15Timers, AFlagThatComesDuringABitInstructionBesideItStays) {
  for (unsigned wait = 0; wait < 30; ++wait) {
    Program p;
    p.mov(kAuxr, 0x80).mov(kTl0, 0xEC).mov(kTh0, 0xFF).setb(kTr0).nop(wait).clr(kTr1).nop(40);
    p.movDirect(0x30, kTcon).halt();
    Bench bench(kPart, p);
    bench.runTo(300);
    EXPECT_EQ(bench.ram(0x30) & 0x20, 0x20) << wait;
  }
}

TEST(Stc15Pins, OfThePwmOnAnStc15w4kAreInputsAfterAReset) {
  Program p;
  p.mov(0x95, 0x00).halt();  // P2M1
  Chip chip(partCalled("stc15w4k32s4"), std::vector<std::uint8_t>(32768, 0), 100);
  chip.settle();
  std::vector<unsigned> levels;
  for (const auto& event : chip.ports().take(1)) levels.push_back(event.level);
  EXPECT_EQ(levels, (std::vector<unsigned>{0x3F, 0x3F, 0x71, 0x7F, 0xCB, 0x30}));
  Bench bench("stc15w4k32s4", p);
  const auto events = bench.runTo(20);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].port, 2);
  EXPECT_EQ(events[0].level, 0xFF);
}

TEST(Stc15Pins, InterruptOnBothEdgesWithoutIt0) {
  for (const bool by_edge : {false, true}) {
    Program p;
    p.ljmp(0x40).at(0x03).put({0x0F}).reti().at(0x40);
    if (by_edge) p.setb(kIt0);
    p.mov(kIe, 0x81).halt();
    Bench bench(kPart, p);
    bench.runTo(100);
    bench.chip().drive(3, 2, false, bench.chip().now());
    bench.runTo(200);
    bench.chip().drive(3, 2, true, bench.chip().now());
    bench.runTo(300);
    EXPECT_EQ(bench.ram(7), by_edge ? 1 : 2);
  }
}

TEST(Stc15Pins, PushPullOrListenAsTheirModeSays) {
  Program p;
  p.mov(0x92, 0x02).mov(0x91, 0x04).nop(4);  // P1M0, P1M1: bit 1 pushes, bit 2 listens.
  p.movDirect(0x30, kP1).clr(kP1_2).movDirect(0x31, kP1).halt();
  Bench bench(kPart, p);
  bench.chip().drive(1, 1, false, 0);
  const auto events = bench.runTo(100);
  EXPECT_EQ(bench.ram(0x30), 0xFB);  // What pushes is not pulled down; what listens reads 0 alone.
  EXPECT_EQ(bench.ram(0x31), 0xFB);
  bench.chip().drive(1, 2, true, 0);
  EXPECT_EQ(bench.chip().ports().pins(1), 0xFF);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].level, 0xFB);  // Such a pin shows as low, as the inputs of other controllers do.
}

}  // namespace
}  // namespace kerfbench::mcs51_child

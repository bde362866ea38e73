// SPDX-License-Identifier: Apache-2.0
// Ports, what is wrong with s51's instructions, and firmware that cannot go on.
#include <gmock/gmock.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Mcs51Ports, ReadModifyWriteReadsTheLatchAndAllElseThePins) {
  // P1.0 is held low from outside while its latch is 1.
  Program p;
  p.nop(10).movDirect(0x30, kP1).put({0x43, kP1, 0x00}).put({0x05, kP1}).put({0x15, kP1});
  p.cpl(kP1_1).put({0xA2, kP1_0, 0x92, 0x08});          // MOV C,P1.0; MOV 21.0,C
  p.put({0x10, kP1_0, 0x02, 0x05, 0x31}).nop().halt();  // JBC P1.0,+2; INC 31
  Bench bench("at89c51", p);
  bench.chip().drive(1, 0, false, 0);
  std::vector<unsigned> levels;
  for (const auto& event : bench.runTo(12 * 100)) levels.push_back(event.level);
  EXPECT_EQ(bench.ram(0x30), 0xFE);
  EXPECT_EQ(bench.ram(0x21) & 1U, 0U);
  EXPECT_EQ(bench.ram(0x31), 0);
  // INC to 00, DEC to FF, CPL to FD, JBC to FC; ORL with 0 changes nothing.
  EXPECT_EQ(levels, (std::vector<unsigned>{0x00, 0xFF, 0xFD, 0xFC}));
}

TEST(Mcs51Ports, APinIsLowWhereTheLatchOrSomebodyOutsidePullsItDown) {
  Program p;
  p.mov(kP1, 0xF0).nop(2);
  const unsigned loop = p.here();
  p.movDirect(0x30, kP1).sjmp(loop);
  Bench bench("at89c51", p);
  bench.runTo(12 * 10);
  EXPECT_EQ(bench.ram(0x30), 0xF0);
  bench.chip().drive(1, 7, false, bench.chip().now());
  bench.chip().drive(1, 0, true, bench.chip().now());
  bench.runTo(12 * 20);
  EXPECT_EQ(bench.ram(0x30), 0x70);
}

TEST(Mcs51Ports, AreHighAfterReset) {
  const Program p = Program().halt();
  Bench bench("at89c51", p);
  EXPECT_EQ(bench.chip().peekSfr(kP1), 0xFF);
  Chip fresh(partCalled("80c31"), std::vector<std::uint8_t>(65536, 0), 100);
  fresh.settle();
  const auto events = fresh.ports().take(1);
  ASSERT_EQ(events.size(), 2U);  // Ports 0 and 2 are the bus.
  EXPECT_EQ(events[0].port, 1);
  EXPECT_EQ(events[1].port, 3);
  EXPECT_EQ(events[0].level, 0xFF);
}

// s51 keeps what software writes to the parity until the accumulator changes. Intel 1994: "Set/cleared by
// hardware each instruction cycle to indicate an odd/even number of 1 bits in the accumulator".
TEST(Mcs51Instructions, SoftwareCannotWriteTheParity) {
  Program p;
  p.movA(0x07).mov(kPsw, 0x00).movDirect(0x30, kPsw).movA(0x03).setb(0xD0).movDirect(0x31, kPsw).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 40);
  EXPECT_EQ(bench.ram(0x30), 1);
  EXPECT_EQ(bench.ram(0x31), 0);
}

// s51 goes on with the old bank of registers after a bit instruction on RS0 or RS1.
TEST(Mcs51Instructions, ABitOfTheBankTakesEffectAtOnce) {
  Program p;
  p.put({0x78, 0x11})
      .setb(0xD3)
      .put({0x78, 0x22})
      .setb(0xD4)
      .put({0x78, 0x44})
      .clr(0xD3)
      .put({0x78, 0x33})
      .halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 40);
  EXPECT_EQ(bench.ram(0x00), 0x11);
  EXPECT_EQ(bench.ram(0x08), 0x22);
  EXPECT_EQ(bench.ram(0x18), 0x44);
  EXPECT_EQ(bench.ram(0x10), 0x33);
}

TEST(Mcs51Instructions, ADivisionByZeroSetsTheOverflowAndClearsTheCarry) {
  Program p;
  p.mov(kB, 0).movA(7).put({0xD3, 0x84}).movDirect(0x30, kPsw).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 20);
  EXPECT_EQ(bench.ram(0x30) & (kCarry | kOverflow), kOverflow);
}

TEST(Mcs51Instructions, TheSecondDataPointerIsChosenByDps) {
  Program p;
  p.put({0x90, 0x12, 0x34}).mov(kAuxr1, 1).put({0x90, 0x56, 0x78, 0xA3}).mov(kAuxr1, 0).put({0xA3}).halt();
  Bench bench("at89s52", p);
  bench.runTo(12 * 40);
  EXPECT_EQ(bench.chip().sfrs()[kDph], 0x12);
  EXPECT_EQ(bench.chip().sfrs()[kDpl], 0x35);
  EXPECT_EQ(bench.chip().sfrs()[kDp1h], 0x56);
  EXPECT_EQ(bench.chip().sfrs()[kDp1l], 0x79);
}

std::string faultOf(std::string_view part, const Program& program) {
  Bench bench(part, program);
  bench.runTo(12 * 100'000);
  return bench.chip().fault();
}

TEST(Mcs51Faults, AnUndefinedOpcodeIsNamedWithItsAddress) {
  Program p;
  p.nop(0x12).put({0xA5}).halt();
  EXPECT_THAT(faultOf("at89c51", p), AllOf(HasSubstr("undefined opcode 0xa5"), HasSubstr("0x0012")));
}

TEST(Mcs51Faults, TheProgramCounterBeyondTheCodeMemoryIsNamed) {
  Program p;
  p.ljmp(0x1000);
  EXPECT_THAT(faultOf("at89c51", p), AllOf(HasSubstr("left the code memory"), HasSubstr("0x1000")));
  EXPECT_EQ(faultOf("at89c52", Program().ljmp(0x1000).at(0x1000).halt()), "");
  // Erased memory is MOV R7,A all the way to its end.
  EXPECT_THAT(faultOf("at89c51", Program().nop()), HasSubstr("0x1000"));
  EXPECT_THAT(faultOf("80c31", Program().ljmp(0xFFFE)), HasSubstr("0x10000"));
}

TEST(Mcs51Faults, AStackBeyondTheInternalRamIsNamed) {
  Program p;
  p.put({0x12, 0x00, 0x00});  // LCALL 0
  EXPECT_THAT(faultOf("at89c51", p), HasSubstr("the stack grew beyond the internal RAM"));
  EXPECT_THAT(faultOf("at89c52", p), HasSubstr("the stack grew beyond the internal RAM"));
  Program q;
  q.mov(kSp, 0).put({0xD0, 0x30}).halt();
  EXPECT_THAT(faultOf("at89c51", q), HasSubstr("more was taken from the stack"));
}

TEST(Mcs51Faults, MemoryThatIsNotThereIsNamed) {
  EXPECT_THAT(faultOf("at89c51", Program().put({0x78, 0x80, 0xE6}).halt()), HasSubstr("internal RAM beyond"));
  EXPECT_EQ(faultOf("at89c52", Program().put({0x78, 0x80, 0xE6}).halt()), "");
  EXPECT_THAT(faultOf("at89c51", Program().put({0x90, 0x00, 0x00, 0xF0}).halt()), HasSubstr("MOVX"));
  EXPECT_EQ(faultOf("80c32", Program().put({0x90, 0xFF, 0xFF, 0xF0, 0xE0}).halt()), "");
}

}  // namespace
}  // namespace kerfbench::mcs51_child

// SPDX-License-Identifier: Apache-2.0
// Waits of one instruction, which are passed over, against the same carried out turn by turn.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

struct End {
  std::vector<emulator::PinEvent> events;
  std::array<std::uint8_t, 256> iram{};
  Tick now{};
  std::uint32_t pc{};
  bool operator==(const End&) const = default;
};

/// `step`: ticks after which the run is cut; 1 lets each instruction stand alone.
End runIn(std::string_view part, const Program& program, Tick until, Tick step) {
  Bench bench(part, program);
  End end;
  for (Tick tick = step; tick < until; tick = std::max(tick + step, bench.chip().now() + 1)) {
    const auto events = bench.runTo(tick);
    end.events.insert(end.events.end(), events.begin(), events.end());
  }
  const auto events = bench.runTo(until);
  end.events.insert(end.events.end(), events.begin(), events.end());
  end.iram = bench.chip().cpu().iram();
  end.now = bench.chip().now();
  end.pc = bench.chip().cpu().pc();
  return end;
}

void expectTheSame(const Program& program, std::size_t edges) {
  for (const std::string_view part : {"at89s52", "stc15f2k60s2"}) {
    const End one_by_one = runIn(part, program, 60'000, 1);
    EXPECT_GE(one_by_one.events.size(), edges) << part;
    for (const Tick step : {7U, 1000U, 60'000U}) {
      const End passed_over = runIn(part, program, 60'000, step);
      EXPECT_TRUE(passed_over == one_by_one) << part << ", cut after " << step;
    }
  }
}

/// Timer 0 inverts P1.0 by its interrupt.
Program withTicks(std::uint8_t reload) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).reti().at(0x40);
  p.mov(kTmod, 0x02).mov(kTl0, reload).mov(kTh0, reload).mov(kIe, 0x82).setb(kTr0);
  return p;
}

TEST(Waits, DelaysByDjnzTakeAllTheirTurns) {
  Program p = withTicks(180);
  const unsigned loop = p.here();
  p.put({0x7A, 200}).djnzR(2, p.here() + 2).cpl(kP1_1);  // MOV R2,#200
  p.put({0x7B, 1}).djnzR(3, p.here() + 2).put({0x7C, 0}).djnzR(4, p.here() + 2).sjmp(loop);
  Program self = withTicks(180);
  const unsigned again = self.here();
  self.put({0x7A, 200, 0xDA, 0xFE}).cpl(kP1_1).put({0x7B, 1, 0xDB, 0xFE, 0x7C, 0, 0xDC, 0xFE}).sjmp(again);
  expectTheSame(p, 10);
  expectTheSame(self, 10);
}

TEST(Waits, ForAnInterruptEndWhenItComes) {
  Program p = withTicks(100);
  p.halt();
  expectTheSame(p, 20);
}

TEST(Waits, ForBitsOfRegistersAndRamEndWhenTheyAreSet) {
  constexpr std::uint8_t kFlag = 0x08, kTf1 = 0x8F;  // Bit 21.0, and the overflow of timer 1.
  Program p;
  p.ljmp(0x40).at(0x0B).setb(kFlag).reti().at(0x40);
  p.mov(kTmod, 0x22).mov(kTh0, 91).mov(kTh1, 17).mov(kIe, 0x82).setb(kTr0).setb(kTr1);
  const unsigned loop = p.here();
  p.jnb(kFlag, p.here()).clr(kFlag).cpl(kP1_0);
  p.jnb(kTf1, p.here()).cpl(kP1_1).jb(kTf1, p.here() + 3).clr(kTf1).sjmp(loop);
  expectTheSame(p, 10);
}

// CJNE A,TL0 compares with a count that runs: no turn is as the one before.
TEST(Waits, ForACountAreNotPassedOver) {
  Program p;
  p.mov(kTmod, 0x02).mov(kTh0, 3).setb(kTr0);
  const unsigned loop = p.here();
  p.put({0x74, 100, 0xB5, kTl0, 0xFD}).cpl(kP1_0).put({0x74, 101, 0xB5, kTl0, 0xFD}).cpl(kP1_1).sjmp(loop);
  const End end = runIn("at89s52", p, 60'000'0, 600'000);
  EXPECT_GE(end.events.size(), 2U);
  expectTheSame(p, 2);
}

// JNB on a pin waits for what drives it.
TEST(Waits, ForAPinEndWhenItIsDriven) {
  Program p;
  p.jb(0xB3, p.here()).cpl(kP1_0).halt();
  Bench bench("at89s52", p);
  bench.runTo(1000);
  const Tick driven = bench.chip().now();
  bench.chip().drive(3, 3, false, driven);
  const auto events = bench.runTo(2000);
  ASSERT_EQ(events.size(), 1U);
  // Two cycles of JB that sees it, and one of CPL.
  EXPECT_EQ(events[0].tick, driven + 36);
}

}  // namespace
}  // namespace kerfbench::mcs51_child

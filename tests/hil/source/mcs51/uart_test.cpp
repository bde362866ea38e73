// SPDX-License-Identifier: Apache-2.0
// The serial port in its modes, both ways (Intel 1994).
#include <gmock/gmock.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::Each;

/// Sends bytes one behind the other as soon as TI is set, from A = 0x41 on.
Program talking(unsigned scon, unsigned pcon, unsigned reload) {
  Program p;
  p.mov(kPcon, pcon).mov(kTmod, 0x20).mov(kTh1, reload).mov(kTl1, reload).mov(kScon, scon).setb(kTr1);
  p.movA(0x41);
  const unsigned loop = p.here();
  p.put({0xF5, kSbuf}).put({0x30, kTiBit, 0xFD}).clr(kTiBit).put({0x04}).sjmp(loop);
  return p;
}

std::vector<Frame> framesOf(Bench& bench, Tick until) {
  bench.runTo(until);
  return bench.chip().uart().takeSent();
}

std::vector<Tick> beginsOf(const std::vector<Frame>& frames) {
  std::vector<Tick> begins;
  for (const Frame& frame : frames) begins.push_back(frame.begins);
  return begins;
}

TEST(Mcs51Uart, TakesItsRateFromTimer1) {
  // Baud = clock/(384 (256 - TH1)), twice that with SMOD; ten bits a byte.
  for (const unsigned smod : {0U, 0x80U}) {
    Bench bench("at89c51", talking(0x40, smod, 0xFD));
    const auto frames = framesOf(bench, 1'000'000);
    const Tick bit = smod != 0 ? 192 * 3 : 384 * 3;
    ASSERT_GT(frames.size(), 50U);
    EXPECT_THAT(stepsOf(beginsOf(frames), 1), Each(10 * bit));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].byte, 0x41 + i);
      EXPECT_EQ(frames[i].bits, 10U);
      EXPECT_EQ(frames[i].done - frames[i].begins, 10 * bit);
      EXPECT_EQ(frames[i].ticks_per_bit, static_cast<double>(bit));
      if (i == 40) break;
    }
  }
}

TEST(Mcs51Uart, FramesFollowTheTimerAndNotTheProgram) {
  // Writes at different moments of a bit begin their frames with the same rollover.
  std::vector<Tick> begins;
  for (unsigned wait = 0; wait < 20; ++wait) {
    Program p;
    p.mov(kTmod, 0x20).mov(kTh1, 0xFD).mov(kTl1, 0xFD).mov(kScon, 0x40).setb(kTr1).nop(110 + wait);
    p.mov(kSbuf, 0x55).halt();
    Bench bench("at89c51", p);
    const auto frames = framesOf(bench, 100'000);
    ASSERT_EQ(frames.size(), 1U);
    begins.push_back(frames[0].begins);
  }
  // SETB ends with cycle 9; the second bit time ends 2 times 32 overflows of 3 cycles later.
  EXPECT_THAT(std::vector<Tick>(begins.begin(), begins.end()), Each(12U * (9 + 192)));
}

TEST(Mcs51Uart, TiComesWithTheStopBit) {
  Program p = talking(0x40, 0, 0xFD);
  Bench bench("at89c51", p);
  while ((bench.chip().sfrs()[kScon] & kTi) == 0) bench.runTo(bench.chip().now() + 1);
  const Tick ti = bench.chip().now();
  const auto frames = bench.chip().uart().takeSent();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_NEAR(static_cast<double>(ti - frames[0].begins), 9.0 * 1152, 36);
}

TEST(Mcs51Uart, HasAFixedRateAndElevenBitsInMode2) {
  for (const unsigned smod : {0U, 0x80U}) {
    Bench bench("at89c51", talking(0x88, smod, 0x00));  // TB8 = 1
    const auto frames = framesOf(bench, 100'000);
    const Tick bit = smod != 0 ? 32 : 64;
    ASSERT_GT(frames.size(), 50U);
    // Between TI and the next write the program takes longer than a bit.
    for (const Tick step : stepsOf(beginsOf(frames), 1)) {
      EXPECT_GT(step, 11 * bit);
      EXPECT_EQ(step % bit, 0U);
    }
    EXPECT_EQ(frames[0].done - frames[0].begins, 11 * bit);
    EXPECT_TRUE(frames[0].ninth);
    EXPECT_EQ(frames[0].bits, 11U);
  }
}

TEST(Mcs51Uart, HasElevenBitsAtTheRateOfTimer1InMode3) {
  Bench bench("at89c51", talking(0xC0, 0x80, 0xFF));
  const auto frames = framesOf(bench, 200'000);
  ASSERT_GT(frames.size(), 50U);
  EXPECT_THAT(stepsOf(beginsOf(frames), 1), Each(11U * 192));
  EXPECT_FALSE(frames[0].ninth);
}

TEST(Mcs51Uart, TakesItsRateFromTimer2WhereToldSo) {
  // Baud = clock/(32 (65536 - RCAP2)).
  Program p;
  p.mov(kRcap2l, 0xD9).mov(kRcap2h, 0xFF).mov(kTl2, 0xD9).mov(kTh2, 0xFF).mov(kScon, 0x40);
  p.mov(kT2con, kTclk | kTr2).movA(0x41);
  const unsigned loop = p.here();
  p.put({0xF5, kSbuf}).put({0x30, kTiBit, 0xFD}).clr(kTiBit).sjmp(loop);
  Bench bench("80c52", p);
  const auto frames = framesOf(bench, 1'000'000);
  ASSERT_GT(frames.size(), 50U);
  EXPECT_THAT(stepsOf(beginsOf(frames), 1), Each(10U * 32 * 39));
  EXPECT_EQ(bench.chip().sfrs()[kT2con] & kTf2, 0);  // As a baud generator it sets no flag.
}

/// Bytes that the firmware finds in SBUF when RI is set, from RAM 30 on.
Program listening(unsigned scon, bool clears = true) {
  Program p;
  p.put({0x78, 0x30}).mov(kTmod, 0x20).mov(kTh1, 0xFD).mov(kTl1, 0xFD).mov(kScon, scon).setb(kTr1);
  const unsigned loop = p.here();
  p.put({0x30, kRiBit, 0xFD}).put({0xA6, kSbuf, 0x08}).put({0xA6, kScon, 0x08});
  if (clears) {
    p.clr(kRiBit).sjmp(loop);
  } else {
    p.halt();
  }
  return p;
}

void hear(Bench& bench, Tick begins, std::uint8_t byte, bool ninth = true) {
  bench.chip().hear({.begins = begins, .done = begins + 1152 * 19 / 2, .byte = byte, .ninth = ninth});
}

TEST(Mcs51Uart, HearsAByteInTheMiddleOfItsStopBit) {
  Bench bench("at89c51", listening(0x50));
  hear(bench, 1200, 0x5A);
  bench.runTo(1200 + 1152 * 19 / 2);
  EXPECT_EQ(bench.ram(0x30), 0);
  bench.runTo(1200 + 1152 * 10);
  EXPECT_EQ(bench.ram(0x30), 0x5A);
  EXPECT_EQ(bench.ram(0x31), 0x50 | kRb8 | kRi);  // RB8 is the stop bit.
}

TEST(Mcs51Uart, HearsNothingWithoutRen) {
  Bench bench("at89c51", listening(0x40));
  hear(bench, 1200, 0x5A);
  bench.runTo(40'000);
  EXPECT_EQ(bench.ram(0x30), 0);
}

TEST(Mcs51Uart, LosesAByteThatComesWhileRiIsStillSet) {
  Bench bench("at89c51", listening(0x50, false));
  hear(bench, 1200, 0x5A);
  hear(bench, 13'000, 0x77);
  bench.runTo(40'000);
  EXPECT_EQ(bench.chip().uart().received(), 0x5A);
}

TEST(Mcs51Uart, HearsNinthBitsAndWithSm2OnlyBytesWhoseNinthIsOne) {
  for (const unsigned sm2 : {0U, 0x20U}) {
    Bench bench("at89c51", listening(0xD0 | sm2));
    hear(bench, 1200, 0x11, true);
    hear(bench, 20'000, 0x22, false);
    hear(bench, 40'000, 0x33, true);
    bench.runTo(60'000);
    EXPECT_EQ(bench.ram(0x30), 0x11);
    EXPECT_EQ(bench.ram(0x31) & kRb8, kRb8);
    EXPECT_EQ(bench.ram(0x32), sm2 != 0 ? 0x33 : 0x22);
    EXPECT_EQ(bench.ram(0x33) & kRb8, sm2 != 0 ? kRb8 : 0);
  }
}

TEST(Mcs51Uart, ShiftsOutOnP3InMode0) {
  Program p;
  p.mov(kScon, 0x00).nop(10).mov(kSbuf, 0xA6).put({0x30, kTiBit, 0xFD}).cpl(kP1_0).halt();
  Bench bench("at89c51", p);
  const auto events = bench.runTo(12 * 60);
  // MOV SBUF ends with cycle 14. One cycle elapses, then each cycle has a bit: data at its begin, the clock
  // low in S3 to S5.
  const auto clock = changesOf(events, 3, 1);
  ASSERT_EQ(clock.size(), 16U);
  unsigned byte = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    EXPECT_EQ(clock[2 * bit], 12U * (15 + bit) + 4);
    EXPECT_EQ(clock[2 * bit + 1], 12U * (15 + bit) + 10);
    unsigned level = 1;
    for (const auto& event : events) {
      if (event.port == 3 && event.tick <= clock[2 * bit + 1]) level = event.level & 1U;
    }
    byte |= level << bit;
  }
  EXPECT_EQ(byte, 0xA6U);
  // TI comes in S1P1 of the tenth cycle behind the write.
  EXPECT_NEAR(static_cast<double>(changesOf(events, 1, 0).front()), 12.0 * (14 + 9 + 2 + 1), 24);
}

TEST(Mcs51Uart, ShiftsInFromP3InMode0) {
  Program p;
  p.nop(10).mov(kScon, 0x10).nop(30).movDirect(0x30, kSbuf).halt();
  Bench bench("at89c51", p);
  bench.runTo(12 * 11);
  for (unsigned cycle = 11; cycle < 40; ++cycle) {
    bench.runTo(12 * Tick{cycle});
    // Bit 0 is taken in cycle 13.
    const unsigned bit = cycle < 12 ? 0 : cycle - 12;
    bench.chip().drive(3, 0, bit < 8 && (0x35U >> bit & 1U) != 0, bench.chip().now());
  }
  bench.runTo(12 * 60);
  EXPECT_EQ(bench.ram(0x30), 0x35U);
}

}  // namespace
}  // namespace kerfbench::mcs51_child

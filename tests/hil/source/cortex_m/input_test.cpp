// SPDX-License-Identifier: Apache-2.0
// Inputs of the STM32F103: levels at their ticks, encoders, captured edges, bytes at the pace of the line.
#include <gmock/gmock.h>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

using CortexMInput = CortexM;

TEST_F(CortexMInput, DrivenLevelsStayWhenTheFirmwareWritesToThePort) {
  const auto source = openChild(optionsFor("held_input"));
  source->drive({1, 8}, false, 1);
  source->drive({1, 8}, true, 5 * kMs);
  source->drive({1, 8}, false, 7 * kMs);
  const auto result = runSource(*source, 10 * kMs, kMs);
  const auto rises = edgesOf(result.events, kPA0);
  const auto falls = edgesOf(result.events, kPA0, false);
  ASSERT_THAT(rises, SizeIs(1));
  ASSERT_THAT(falls, SizeIs(1));
  EXPECT_GE(rises[0], 5 * kMs);
  EXPECT_LT(rises[0], 5 * kMs + 60);
  EXPECT_GE(falls[0], 7 * kMs);
  EXPECT_LT(falls[0], 7 * kMs + 60);
}

TEST_F(CortexMInput, APullUpHoldsAPinThatNobodyDrives) {
  const auto result = run("held_input", kMs);
  EXPECT_THAT(edgesOf(result.events, kPA0), SizeIs(1));
  EXPECT_THAT(edgesOf(result.events, kPA0, false), SizeIs(0));
}

TEST_F(CortexMInput, ExternalInterruptsSeeEdgesAtTheirTicks) {
  const auto source = openChild(optionsFor("edges"));
  std::vector<Tick> rises;
  for (Tick tick = kMs; tick < 9 * kMs; tick += 5003) {
    source->drive({1, 0}, true, tick);
    source->drive({1, 1}, (rises.size() & 1) == 0, tick + 1000);
    source->drive({1, 0}, false, tick + 2500);
    rises.push_back(tick);
  }
  const auto result = runSource(*source, 10 * kMs, kMs / 2);
  ASSERT_THAT(result.events, SizeIs(2 * rises.size()));
  for (std::size_t i = 0; i < rises.size(); ++i) {
    for (const std::size_t which : {0U, 1U}) {
      const PinEvent& event = result.events[2 * i + which];
      EXPECT_EQ(event.changed, 1U << which);
      // Twelve cycles of entry and the handler's way to its store; the core sleeps before.
      EXPECT_GE(event.tick, rises[i] + which * 1000 + 12);
      EXPECT_LE(event.tick, rises[i] + which * 1000 + 50);
    }
  }
}

// The bench gives an input only when it knows it: just before the quantum in which it comes.
TEST_F(CortexMInput, NothingDependsOnTheQuantumInWhichAnInputIsGiven) {
  const auto runIn = [](Tick quantum) {
    const auto source = openChild(optionsFor("edges"));
    Tick next = kMs / 2;
    bool level = false;
    return runSource(*source, 3 * kMs, quantum, [&](Tick until) {
      for (; next <= until; next += 997) source->drive({1, 1}, level = !level, next);
    });
  };
  const auto whole = runIn(3 * kMs);
  EXPECT_GT(whole.events.size(), 150U);
  EXPECT_EQ(runIn(1000).events, whole.events);
  EXPECT_EQ(runIn(61).events, whole.events);
}

/// Turns an encoder on two pins by a number of edges; the sign says which way.
Tick turn(SignalSource& source, PinId a, PinId b, int edges, Tick from, int& phase) {
  for (int i = 0; i < std::abs(edges); ++i, from += 500) {
    const int before = phase;
    phase = (phase + (edges > 0 ? 1 : 3)) % 4;
    const auto level = [](int at) { return std::pair{at == 1 || at == 2, at == 2 || at == 3}; };
    if (level(before).first != level(phase).first) source.drive(a, level(phase).first, from);
    if (level(before).second != level(phase).second) source.drive(b, level(phase).second, from);
  }
  return from;
}

TEST_F(CortexMInput, EncodersCountByBothLinesOrByOne) {
  const auto source = openChild(optionsFor("encoder"));
  int phase = 0;
  Tick tick = turn(*source, {1, 6}, {1, 7}, 400, kMs, phase);
  tick = turn(*source, {1, 6}, {1, 7}, -100, tick, phase);
  phase = 0;
  tick = turn(*source, {0, 6}, {0, 7}, -400, tick, phase);
  for (int i = 0; i < 7; ++i, tick += 1000) {
    source->drive(kPA0, true, tick);
    source->drive(kPA0, false, tick + 300);
  }
  auto result = runSource(*source, tick + kMs, kMs);
  ASSERT_EQ(result.stop, Stop::kReached) << result.message;
  source->uartWrite(bytesOf("?"));
  Batch batch;
  std::string said;
  for (Tick until = tick + 2 * kMs; until < tick + 5 * kMs; until += kMs) {
    ASSERT_EQ(source->advance(until, batch), Stop::kReached) << source->message();
    said.append(batch.uart.begin(), batch.uart.end());
  }
  // 300 of both edges; half of -400 by one line's, below 65536; and seven rising edges.
  EXPECT_THAT(linesOf(said), ElementsAre("300", "65336", "7"));
}

TEST_F(CortexMInput, CapturedEdgesAreATimersCountsApart) {
  const auto source = openChild(optionsFor("capture"));
  source->drive(kPA0, true, 2 * kMs);
  source->drive(kPA0, false, 2 * kMs + 3000);
  source->drive(kPA0, true, 2 * kMs + 12'345);
  const auto lines = linesOf(runSource(*source, 5 * kMs, kMs).uart);
  ASSERT_THAT(lines, SizeIs(1));
  // An input is looked at between instructions, of which the loop's longest takes 5 cycles.
  EXPECT_NEAR(std::stod(lines[0]), 12'345.0, 5.0);
}

/// What comes back of a text that is sent at 1 ms.
Run echoOf(const std::string& text, std::string_view firmware, Tick until) {
  const auto source = openChild(optionsFor(firmware));
  Batch batch;
  EXPECT_EQ(source->advance(kMs, batch), Stop::kReached);
  source->uartWrite(bytesOf(text));
  Run result;
  for (Tick tick = kMs; tick < until;) {
    result.stop = source->advance(tick += kMs / 4, batch);
    if (result.stop != Stop::kReached) break;
    result.events.insert(result.events.end(), batch.events.begin(), batch.events.end());
    result.uart.append(batch.uart.begin(), batch.uart.end());
  }
  result.message = source->message();
  return result;
}

TEST_F(CortexMInput, EchoByInterruptKeepsTheLinesPace) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += static_cast<char>('!' + i % 90);
  std::string expected = text;
  for (auto& c : expected) ++c;
  const auto result = echoOf(text, "echo", 12 * kMs);
  EXPECT_EQ(result.uart, expected);
  ASSERT_THAT(result.events, SizeIs(200));
  // Ten bits of 288 cycles at 250 000 baud.
  EXPECT_EQ(result.events.back().tick - result.events.front().tick, 199U * 2880U);
  EXPECT_NEAR(static_cast<double>(result.events.front().tick), kMs + 2880.0, 60.0);
}

TEST_F(CortexMInput, EchoByDmaTakesHalvesEndsAndIdleLines) {
  std::string text;
  for (int i = 0; i < 77; ++i) text += static_cast<char>('!' + i % 90);
  EXPECT_EQ(echoOf(text, "echo_dma", 20 * kMs).uart, text);
}

TEST_F(CortexMInput, ATransmitterBeginsWithAnIdleFrame) {
  auto options = optionsFor("talk");
  options.baud = 115'200;
  const auto source = openChild(options);
  Batch batch;
  // The firmware switches it on at some 700 ticks, and a frame has 6250.
  ASSERT_EQ(source->advance(13'000, batch), Stop::kReached);
  EXPECT_TRUE(batch.uart.empty());
  ASSERT_EQ(source->advance(14'000, batch), Stop::kReached);
  EXPECT_EQ(std::string(batch.uart.begin(), batch.uart.end()), "s");
}

TEST_F(CortexMInput, AnotherRateEndsTheRunAndIsNamed) {
  for (const std::uint32_t baud : {109'800U, 115'200U, 121'500U}) {
    auto options = optionsFor("talk");
    options.baud = baud;
    const auto result = runWith(options, 20 * kMs);
    EXPECT_EQ(result.uart, "steady\n") << baud;
  }
  for (const std::uint32_t baud : {9600U, 109'000U, 122'500U, 250'000U}) {
    auto options = optionsFor("talk");
    options.baud = baud;
    const auto result = runWith(options, 20 * kMs);
    EXPECT_EQ(result.stop, Stop::kMisheard) << baud;
    EXPECT_THAT(result.message, HasSubstr("USART1 runs at 115200 baud, with a core clock of 72000000 Hz"));
    EXPECT_THAT(result.message, HasSubstr("the bench at " + std::to_string(baud)));
    EXPECT_EQ(result.uart, "");
  }
}

TEST_F(CortexMInput, WhereNobodyListensTheRateMayBeAny) {
  auto options = optionsFor("talk");
  options.baud = 115'200;
  const auto heard = runWith(options, 20 * kMs);
  options.baud = 0;
  const auto unheard = runWith(options, 20 * kMs);
  EXPECT_EQ(unheard.stop, heard.stop) << unheard.message;
  EXPECT_EQ(unheard.message, heard.message);
  EXPECT_EQ(unheard.uart, "steady\n");
}

TEST_F(CortexMInput, AnotherFrameIsNamed) {
  const auto result = run("seven_bits", 20 * kMs);
  EXPECT_EQ(result.stop, Stop::kMisheard);
  EXPECT_THAT(result.message, HasSubstr("takes 12 bits, and the bench has 10 (8N1)"));
}

TEST_F(CortexMInput, AnotherClockThanTheScenariosIsNamed) {
  const auto result = run("wrong_clock", 30 * kMs);
  EXPECT_EQ(result.stop, Stop::kMisheard);
  EXPECT_THAT(result.message, HasSubstr("runs its core at 64000000 Hz from PLL"));
  EXPECT_THAT(result.message, HasSubstr("the scenario says 72000000 Hz"));
}

TEST_F(CortexMInput, AFasterClockThanTheScenariosIsNamedThoughPinsChangeTwiceInATickOfIt) {
  auto options = optionsFor("pulses");
  options.clock_hz = 8'000'000;
  const auto source = openChild(options);
  const auto result = runSource(*source, 240'000, 4'000);
  EXPECT_EQ(result.stop, Stop::kMisheard) << result.message;
  EXPECT_THAT(result.message, HasSubstr("runs its core at 72000000 Hz"));
}

}  // namespace
}  // namespace kerfbench::source::cortex_m

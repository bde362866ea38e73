// SPDX-License-Identifier: Apache-2.0
// Inputs of the controller: levels at exact ticks, and bytes at the pace of the line.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/hil/source/avr_run.h"

namespace kerfbench::source {
namespace {

constexpr PinId kPD2{3, 2};
constexpr PinId kPD3{3, 3};
constexpr PinId kPL0{11, 0};

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(AvrInput, DrivenInputStaysWhenTheFirmwareWritesToItsPort) {
  const auto source = openChild(avrOptions("held_input"));
  source->drive(kPL0, false, 1);
  source->drive(kPL0, true, 5 * kMs);
  source->drive(kPL0, false, 7 * kMs);
  const auto run = runSource(*source, 10 * kMs, kMs);
  const auto rises = edgesOf(run.events, kPA0, true);
  const auto falls = edgesOf(run.events, kPA0, false);
  ASSERT_EQ(rises.size(), 1U);
  ASSERT_EQ(falls.size(), 1U);
  EXPECT_GE(rises[0], 5 * kMs);
  EXPECT_LT(rises[0], 5 * kMs + 40);
  EXPECT_GE(falls[0], 7 * kMs);
  EXPECT_LT(falls[0], 7 * kMs + 40);
}

TEST(AvrInput, ExternalInterruptsSeeEdgesAtTheirTicks) {
  const auto source = openChild(avrOptions("edges"));
  std::vector<Tick> rises;
  std::vector<Tick> changes;
  for (Tick tick = kMs; tick < 9 * kMs; tick += 1001) {
    source->drive(kPD2, true, tick);
    source->drive(kPD3, (rises.size() & 1) == 0, tick + 200);
    source->drive(kPD2, false, tick + 500);
    rises.push_back(tick);
    changes.push_back(tick + 200);
  }
  const auto run = runSource(*source, 10 * kMs, kMs / 2);
  ASSERT_EQ(run.events.size(), rises.size() + changes.size());
  for (std::size_t i = 0; i < rises.size(); ++i) {
    // The interrupt takes five cycles, the jump three, and the store; before it at most one instruction of
    // the loop.
    for (const auto& [event, tick] :
         {std::pair{run.events[2 * i], rises[i]}, {run.events[2 * i + 1], changes[i]}}) {
      EXPECT_GE(event.tick, tick + 8);
      EXPECT_LE(event.tick, tick + 24);
    }
    EXPECT_EQ(run.events[2 * i].changed, 1);
    EXPECT_EQ(run.events[2 * i + 1].changed, 2);
  }
}

TEST(AvrInput, EchoComesBackAtTenBitTimesPerByte) {
  const auto source = openChild(avrOptions("echo"));
  std::string text;
  for (int i = 0; i < 500; ++i) text += static_cast<char>('!' + i % 90);
  std::string expected = text;
  for (auto& c : expected) ++c;
  Batch batch;
  ASSERT_EQ(source->advance(kMs, batch), Stop::kReached);
  source->uartWrite(bytesOf(text));
  std::vector<PinEvent> events;
  std::string echoed;
  for (Tick tick = kMs; tick < 25 * kMs && echoed.size() < text.size();) {
    ASSERT_EQ(source->advance(tick += 100, batch), Stop::kReached);
    events.insert(events.end(), batch.events.begin(), batch.events.end());
    echoed.append(batch.uart.begin(), batch.uart.end());
  }
  EXPECT_EQ(echoed, expected);
  ASSERT_EQ(events.size(), text.size());
  // At 250 000 baud 10 bits are 640 cycles; simavr on its own takes 11 bits.
  EXPECT_NEAR(static_cast<double>(events.back().tick - events.front().tick) / 499.0, 640.0, 0.5);
  EXPECT_NEAR(static_cast<double>(events.front().tick), kMs + 640.0, 40.0);
  EXPECT_NEAR(static_cast<double>(batch.watermark), kMs + 501 * 640.0, 300.0);
}

TEST(AvrInput, SlowReaderLosesNothing) {
  const auto source = openChild(avrOptions("slow_reader"));
  std::string text;
  for (int i = 0; i < 300; ++i) text += static_cast<char>('!' + i % 90);
  Batch batch;
  ASSERT_EQ(source->advance(kMs, batch), Stop::kReached);
  source->uartWrite(bytesOf(text));
  std::string echoed;
  for (Tick tick = kMs; tick < 120 * kMs;) {
    ASSERT_EQ(source->advance(tick += kMs, batch), Stop::kReached);
    echoed.append(batch.uart.begin(), batch.uart.end());
  }
  EXPECT_EQ(echoed, text);
}

TEST(AvrInput, RunsWithInputsRepeatToTheTickForEveryQuantum) {
  const auto run = [](Tick quantum) {
    const auto source = openChild(avrOptions("edges"));
    for (Tick tick = 2000; tick < 15 * kMs; tick += 37) {
      source->drive(kPD2, (tick * 7919 >> 5 & 1) != 0, tick);
      source->drive(kPD3, (tick * 104729 >> 6 & 1) != 0, tick + tick % 30);
    }
    return runSource(*source, 16 * kMs, quantum).events;
  };
  const auto reference = run(kMs / 10);
  EXPECT_GT(reference.size(), 1000U);
  for (const Tick quantum : {kMs / 10, Tick{13}, kMs, 16 * kMs})
    EXPECT_EQ(run(quantum), reference) << quantum;
}

TEST(AvrInput, DrivingInThePastIsRefused) {
  const auto source = openChild(avrOptions("edges"));
  Batch batch;
  ASSERT_EQ(source->advance(kMs, batch), Stop::kReached);
  EXPECT_THROW(source->drive(kPD2, true, kMs), std::invalid_argument);
  source->drive(kPD2, true, kMs + 10);
  EXPECT_THROW(source->drive(kPD2, false, kMs + 9), std::invalid_argument);
  EXPECT_THROW((void)source->advance(kMs, batch), std::invalid_argument);
}

TEST(AvrInput, APinThatTheControllerLacksEndsTheRunInWords) {
  const auto source = openChild(avrOptions("edges"));
  source->drive({24, 9}, true, 10);
  Batch batch;
  EXPECT_EQ(source->advance(kMs, batch), Stop::kCrashed);
  EXPECT_THAT(source->message(), ::testing::HasSubstr("no pin"));
}

}  // namespace
}  // namespace kerfbench::source

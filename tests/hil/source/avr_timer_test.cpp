// SPDX-License-Identifier: Apache-2.0
// Timers, the heart of pulse-making firmware. Expected cycles are those of the ATmega2560 and ATmega328P
// datasheets.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/hil/source/avr_run.h"

namespace kerfbench::source {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::Le;

std::vector<Tick> differences(const std::vector<Tick>& ticks, std::size_t skip = 0) {
  std::vector<Tick> result;
  for (std::size_t i = skip + 1; i < ticks.size(); ++i) result.push_back(ticks[i] - ticks[i - 1]);
  return result;
}

double mean(const std::vector<Tick>& values) {
  double sum = 0;
  for (const Tick value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

class ZeroTop : public ::testing::TestWithParam<const char*> {};

TEST_P(ZeroTop, CtcTimerWithTopZeroInterruptsAndThenKeepsItsPeriod) {
  const auto source = openChild(avrOptions("zero_top", GetParam()));
  const auto run = runSource(*source, 10 * kMs, kMs / 2);
  ASSERT_EQ(run.stop, Stop::kReached) << run.message;
  std::vector<Tick> toggles;
  for (const auto& event : run.events) {
    if (event.port == 1 && (event.changed & 1) != 0) toggles.push_back(event.tick);
  }
  // The first interrupt comes at once, and the flag that was set meanwhile may bring one more.
  ASSERT_GE(toggles.size(), 99U);
  EXPECT_LT(toggles[0], 200U);
  const auto periods = differences(toggles, 2);
  EXPECT_THAT(periods, Each(AllOf(Ge(1598U), Le(1602U))));
  EXPECT_DOUBLE_EQ(std::round(mean(periods) * 10) / 10, 1600.0);
}
INSTANTIATE_TEST_SUITE_P(Controllers, ZeroTop, ::testing::Values("atmega2560", "atmega328p"));

TEST(AvrTimer, CountWrittenWhileStoppedIsWhereTheTimerStarts) {
  const auto run = runAvr("kept_count", 20 * kMs);
  const auto rises = edgesOf(run.events, kPA0, true);
  const auto falls = edgesOf(run.events, kPA0, false);
  ASSERT_EQ(rises.size(), 19U);
  ASSERT_EQ(falls.size(), 19U);
  for (std::size_t i = 0; i < rises.size(); ++i) {
    // The pulse has 40 clocks of 8 cycles and the entry of the interrupt; simavr on its own makes it 2048.
    EXPECT_GE(falls[i] - rises[i], 320U);
    EXPECT_LE(falls[i] - rises[i], 365U);
  }
}

TEST(AvrTimer, PulsesAreExactInNumberAndPeriodAndBothAxesStayTogether) {
  const auto run = runAvr("pulses", 60 * kMs);
  const auto rises = edgesOf(run.events, kPA0);
  ASSERT_EQ(rises.size(), 1000U);
  EXPECT_EQ(edgesOf(run.events, {0, 2}), rises);
  EXPECT_EQ(run.uart, "D");
  // The pins of one store are one event; 1 for DIR, 2 for each pulse.
  EXPECT_EQ(run.events.size(), 2001U);
  EXPECT_EQ(run.events[1].changed, 0x05);
  EXPECT_EQ(run.events[1].level, 0x07);
  const auto periods = differences(rises);
  EXPECT_THAT(periods, Each(AllOf(Ge(637U), Le(643U))));
  EXPECT_NEAR(mean(periods), 640.0, 0.01);
}

TEST(AvrTimer, PulseTrainIsTheSameForEveryQuantum) {
  const auto reference = runAvr("pulses", 48 * kMs, kMs / 10);
  for (const Tick quantum : {Tick{7}, Tick{333}, kMs / 2, kMs, 48 * kMs}) {
    const auto run = runAvr("pulses", 48 * kMs, quantum);
    EXPECT_EQ(run.events, reference.events) << "quantum " << quantum;
    EXPECT_EQ(run.uart, reference.uart) << "quantum " << quantum;
  }
}

TEST(AvrTimer, LaserPwmFollowsItsCompareRegisterWithoutAGlitch) {
  constexpr PinId kLaser{1, 7};
  constexpr PinId kPhase{1, 6};
  const auto run = runAvr("pwm", 5 * kMs);
  const auto rises = edgesOf(run.events, kLaser, true);
  const auto falls = edgesOf(run.events, kLaser, false);
  const auto phases = edgesOf(run.events, kPhase, true);
  const auto phase_falls = edgesOf(run.events, kPhase, false);
  ASSERT_EQ(phases.size(), 2U);
  ASSERT_EQ(phase_falls.size(), 1U);
  ASSERT_EQ(rises.size(), falls.size());
  int quarter = 0;
  int three_quarters = 0;
  for (std::size_t i = 0; i + 1 < rises.size(); ++i) {
    const Tick width = falls[i] - rises[i];
    EXPECT_TRUE(width == 64 || width == 192) << "at " << rises[i] << ": " << width;
    EXPECT_EQ(rises[i + 1] - rises[i], 256U);
    (width == 64 ? quarter : three_quarters) += 1;
  }
  EXPECT_NEAR(quarter, 62, 2);
  EXPECT_NEAR(three_quarters, 62, 2);
  // OCR0A = 255: on for a whole millisecond, then off with the disconnection and not a period later.
  EXPECT_GT(falls.back() - rises.back(), 15'700U);
  EXPECT_NEAR(static_cast<double>(falls.back()), static_cast<double>(phases[1]), 16.0);
}

TEST(AvrTimer, SleepingFirmwareWakesWithItsTimer) {
  for (const Tick quantum : {Tick{100}, kMs / 2, 20 * kMs}) {
    const auto run = runAvr("nap", 20 * kMs, quantum);
    ASSERT_EQ(run.events.size(), 19U);
    std::vector<Tick> ticks;
    for (const auto& event : run.events) ticks.push_back(event.tick);
    EXPECT_THAT(differences(ticks), Each(16'000U));
    EXPECT_EQ(run.events, runAvr("nap", 20 * kMs, kMs).events);
  }
}

TEST(AvrTimer, AnInterruptTakesFourCyclesLongerOutOfSleep) {
  const auto run = runAvr("wake", 20 * kMs);
  std::vector<int> awake, asleep;
  for (const auto& event : run.events) {
    if (event.level != 0) ((event.level & 0x80) != 0 ? asleep : awake).push_back(event.level & 0x7F);
  }
  ASSERT_GT(awake.size(), 100U);
  ASSERT_GT(asleep.size(), 100U);
  // Awake it waits for the end of an instruction of the loop: none, at best.
  const int prompt = *std::ranges::min_element(awake);
  EXPECT_LE(*std::ranges::max_element(awake), prompt + 3);
  EXPECT_THAT(asleep, Each(prompt + 4));
}

TEST(AvrTimer, WatchdogResetsAndPinsLetGo) {
  const auto run = runAvr("watchdog", 100 * kMs);
  EXPECT_EQ(run.stop, Stop::kReached) << run.message;
  EXPECT_GE(edgesOf(run.events, kPA0, true).size(), 5U);
  EXPECT_GE(edgesOf(run.events, kPA0, false).size(), 5U);
}

TEST(AvrTimer, SettingABitOfPinTogglesOnlyThatBit) {
  const auto run = runAvr("pin_toggle", kMs / 100);
  ASSERT_GT(run.events.size(), 10U);
  EXPECT_EQ(run.events[0].level, 0xF0);
  for (std::size_t i = 1; i < run.events.size(); ++i) EXPECT_EQ(run.events[i].changed, 1);
}

}  // namespace
}  // namespace kerfbench::source

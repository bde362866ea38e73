// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/pin_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::evidence {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr PinId kPulX{0, 0};
constexpr PinId kDirX{0, 1};
constexpr PinId kPulY{0, 2};
constexpr PinId kGate{2, 3};
constexpr std::uint16_t kGateHigh = 1U << 3U;

/// Recording with ticks of a microsecond.
source::PinRecording recordingOf(const std::vector<PinEvent>& outputs,
                                 const std::vector<SensorEdge>& sensors = {}) {
  source::PinRecording recording;
  recording.rate = {1, 1'000'000};
  recording.outputs = source::PinEvents(outputs);
  recording.sensors = base::SpilledVector<SensorEdge>(sensors);
  recording.end = 1'000'000;
  return recording;
}

PinWiring wiringOfX() {
  PinWiring wiring;
  wiring.signals.assign(Signal::kGalvoXPul, kPulX);
  wiring.signals.assign(Signal::kGalvoXDir, kDirX);
  wiring.signals.assign(Signal::kGalvoYPul, kPulY);
  wiring.signals.assign(Signal::kLaserGate, kGate);
  const DriverProfile drive{"drive", true, 5e-6, 10e-6, 2e-6, 2e-6};
  wiring.drives = {{"galvo_x", Signal::kGalvoXPul, Signal::kGalvoXDir, drive},
                   {"galvo_y", Signal::kGalvoYPul, Signal::kGalvoYDir, drive}};
  wiring.encoder_count_mm = 0.01;
  wiring.power_meter_delay_s = 100e-6;
  return wiring;
}

TEST(PinEvidence, TimesThePulsesOfEachDriveThatIsWiredWhole) {
  const auto pins =
      pinEvidence(recordingOf({{100, 0, 2, 2, 0}, {107, 0, 1, 3, 0}, {110, 0, 1, 2, 0}}), wiringOfX());
  ASSERT_THAT(pins.pulses, SizeIs(1));  // DIR of Y is not wired.
  EXPECT_EQ(pins.pulses[0].axis, "galvo_x");
  EXPECT_EQ(pins.pulses[0].pulses, 1U);
  EXPECT_NEAR(pins.pulses[0].min_setup_s, 7e-6, 1e-12);
  EXPECT_NEAR(pins.pulses[0].min_width_s, 3e-6, 1e-12);
}

TEST(PinEvidence, AGateThatItsPwmChopsOpensOncePerCut) {
  std::vector<PinEvent> events;
  // Two cuts of three pulses of 0.2 ms, 1 ms apart; 1.2 ms of darkness between the cuts.
  for (const std::uint64_t cut : {1000U, 4400U}) {
    for (std::uint64_t pulse = 0; pulse < 3; ++pulse) {
      events.push_back({cut + 1000 * pulse, 2, kGateHigh, kGateHigh, 0});
      events.push_back({cut + 1000 * pulse + 200, 2, kGateHigh, 0, 0});
    }
  }
  const PinEvidence chopped = pinEvidence(recordingOf(events), wiringOfX());
  ASSERT_THAT(chopped.gates, SizeIs(2));
  EXPECT_THAT(chopped.gates[0].on_s, DoubleEq(1e-3));
  EXPECT_THAT(chopped.gates[0].off_s, DoubleEq(3.2e-3));
  EXPECT_THAT(chopped.gates[1].on_s, DoubleEq(4.4e-3));
  EXPECT_THAT(chopped.light, SizeIs(6)) << "the light is that of the pulses";
  PinWiring with_pwm = wiringOfX();
  with_pwm.signals.assign(Signal::kLaserPwm, {2, 4});
  EXPECT_THAT(pinEvidence(recordingOf(events), with_pwm).gates, SizeIs(6)) << "such a gate is not chopped";
}

TEST(PinEvidence, AGateThatAnOpenGuardShutsIsNotChopped) {
  // The guard bounces for 0.5 ms; the gate is shut 50 us after it opens, and opened with it again.
  const std::vector<PinEvent> events{{1000, 2, kGateHigh, kGateHigh, 0},
                                     {2050, 2, kGateHigh, 0, 0},
                                     {2550, 2, kGateHigh, kGateHigh, 0},
                                     {4000, 2, kGateHigh, 0, 0}};
  const auto pins = pinEvidence(recordingOf(events, {{1, Signal::kInterlock, true},
                                                     {2000, Signal::kInterlock, false},
                                                     {2500, Signal::kInterlock, true}}),
                                wiringOfX());
  ASSERT_THAT(pins.gates, SizeIs(2));
  EXPECT_THAT(pins.gates[0].off_s, DoubleEq(2.05e-3));
  EXPECT_THAT(pins.gates[1].on_s, DoubleEq(2.55e-3));
}

TEST(PinEvidence, GatesAreTheIntervalsInWhichTheLineWasHighAndTheLastEndsWithTheRecording) {
  const auto pins = pinEvidence(recordingOf({{1000, 2, kGateHigh, kGateHigh, 0},
                                             {1500, 2, 1, kGateHigh | 1U, 0},
                                             {2500, 2, kGateHigh, 1, 0},
                                             {4000, 2, kGateHigh, kGateHigh, 0}}),
                                wiringOfX());
  ASSERT_THAT(pins.gates, SizeIs(2));
  EXPECT_THAT(pins.gates[0].on_s, DoubleEq(1e-3));
  EXPECT_THAT(pins.gates[0].off_s, DoubleEq(2.5e-3));
  EXPECT_THAT(pins.gates[1].on_s, DoubleEq(4e-3));
  EXPECT_THAT(pins.gates[1].off_s, DoubleEq(1.0));
}

/// Each level of the gate turned round, and the write of a firmware that makes the pin an output.
std::vector<PinEvent> inverted(std::vector<PinEvent> events) {
  for (PinEvent& event : events) event.level ^= kGateHigh;
  events.insert(events.begin(), {10, 2, kGateHigh, kGateHigh, 0});
  return events;
}

TEST(PinEvidence, AGateThatIsOpenWhileLowSaysTheSameAsItsInverse) {
  const std::vector<PinEvent> events{{1000, 2, kGateHigh, kGateHigh, 0},
                                     {1500, 2, 1, kGateHigh | 1U, 0},
                                     {2500, 2, kGateHigh, 1, 0},
                                     {4000, 2, kGateHigh, kGateHigh | 1U, 0},
                                     {5000, 2, kGateHigh, 1, 0}};
  PinWiring low = wiringOfX();
  low.gate_low = true;
  const PinEvidence usual = pinEvidence(recordingOf(events), wiringOfX());
  const PinEvidence other = pinEvidence(recordingOf(inverted(events)), low);
  ASSERT_THAT(usual.gates, SizeIs(2));
  ASSERT_THAT(other.gates, SizeIs(2));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(other.gates[i].on_s, usual.gates[i].on_s);
    EXPECT_EQ(other.gates[i].off_s, usual.gates[i].off_s);
  }
  ASSERT_THAT(other.light, SizeIs(2));
  EXPECT_EQ(other.light[1].from_s, usual.light[1].from_s);
}

TEST(PinEvidence, AGateOfTheWrongPolarityIsOpenBetweenTheCutsAndUpToTheEnd) {
  const std::vector<PinEvent> events{{1000, 2, kGateHigh, kGateHigh, 0},
                                     {2500, 2, kGateHigh, 0, 0},
                                     {4000, 2, kGateHigh, kGateHigh, 0},
                                     {6000, 2, kGateHigh, 0, 0}};
  PinWiring low = wiringOfX();
  low.gate_low = true;
  const PinEvidence pins = pinEvidence(recordingOf(events), low);
  ASSERT_THAT(pins.gates, SizeIs(2));
  EXPECT_THAT(pins.gates[0].on_s, DoubleEq(2.5e-3));
  EXPECT_THAT(pins.gates[0].off_s, DoubleEq(4e-3));
  EXPECT_THAT(pins.gates[1].off_s, DoubleEq(1.0));
}

TEST(PinEvidence, APinThatNobodyHasDrivenYetOpensNoGate) {
  PinWiring low = wiringOfX();
  low.gate_low = true;
  // Other pins of the port are written long before the gate's is made an output.
  const auto pins = pinEvidence(
      recordingOf({{100, 2, 1, 1, 0}, {200, 2, 1, 0, 0}, {300, 2, kGateHigh, kGateHigh, 0}}), low);
  EXPECT_THAT(pins.gates, IsEmpty());
  EXPECT_THAT(pins.light, IsEmpty());
}

TEST(PinEvidence, AReleasedLowGateIsOpenAsThePinsSayIt) {
  PinWiring low = wiringOfX();
  low.gate_low = true;
  // The firmware has driven the pin, and a reset lets it float: the stream has it low from then on.
  const auto pins =
      pinEvidence(recordingOf({{100, 2, kGateHigh, kGateHigh, 0}, {900, 2, kGateHigh, 0, 0}}), low);
  ASSERT_THAT(pins.gates, SizeIs(1));
  EXPECT_THAT(pins.gates[0].off_s, DoubleEq(1.0));
}

TEST(PinEvidence, TheDemandMayBeTheShareOfLow) {
  constexpr std::uint16_t kPwmHigh = 1U << 4U;
  PinWiring low = wiringOfX();
  low.signals.assign(Signal::kLaserPwm, {2, 4});
  low.pwm_low = true;
  const auto pins = pinEvidence(recordingOf({{500, 2, kGateHigh, kGateHigh, 0},
                                             {1000, 2, kPwmHigh, kGateHigh | kPwmHigh, 0},
                                             {2000, 2, kPwmHigh, kGateHigh, 0},
                                             {2600, 2, kPwmHigh, kGateHigh | kPwmHigh, 0},
                                             {3000, 2, kGateHigh, kPwmHigh, 0}}),
                                low);
  ASSERT_THAT(pins.gates, SizeIs(1));
  ASSERT_THAT(pins.light, SizeIs(1)) << "nobody has asked for power before the first pulse";
  EXPECT_THAT(pins.light[0].from_s, DoubleEq(2e-3));
  EXPECT_THAT(pins.light[0].to_s, DoubleEq(2.6e-3));
}

TEST(PinEvidence, OnePinMayEnableTwoDrives) {
  PinWiring wiring = wiringOfX();
  wiring.signals.assign(Signal::kGalvoYDir, {0, 3});
  wiring.signals.assign(Signal::kGalvoXEnable, {1, 0});
  wiring.signals.assign(Signal::kGalvoYEnable, {1, 0});
  const auto pins = pinEvidence(
      recordingOf(
          {{100, 0, 5, 5, 0}, {110, 0, 5, 0, 0}, {200, 1, 1, 1, 0}, {300, 0, 5, 5, 0}, {310, 0, 5, 0, 0}}),
      wiring);
  ASSERT_THAT(pins.pulses, SizeIs(2));
  for (const PulseTiming& timing : pins.pulses) {
    EXPECT_EQ(timing.pulses, 2U);
    EXPECT_EQ(timing.disabled_pulses, 1U);
    EXPECT_NEAR(timing.min_enable_setup_s, 100e-6, 1e-12);
  }
}

TEST(PinEvidence, WithoutALineOfTheGateThereIsNoGate) {
  PinWiring wiring = wiringOfX();
  wiring.signals = {};
  const auto pins = pinEvidence(recordingOf({{1000, 2, kGateHigh, kGateHigh, 0}}), wiring);
  EXPECT_THAT(pins.gates, IsEmpty());
  EXPECT_THAT(pins.pulses, IsEmpty());
}

TEST(PinEvidence, EachChangeOfThePowerMetersLineIsAQuantumAndItsDelayIsTakenOff) {
  const auto pins = pinEvidence(recordingOf({}, {{500, Signal::kPowerMonitor, true},
                                                 {600, Signal::kPowerMonitor, true},
                                                 {700, Signal::kInterlock, true},
                                                 {900, Signal::kPowerMonitor, false}}),
                                wiringOfX());
  EXPECT_THAT(pins.power_edges_s, ElementsAre(DoubleEq(500e-6 - 100e-6), DoubleEq(900e-6 - 100e-6)));
}

TEST(PinEvidence, TheBeltMovesByTheCountsOfItsEncoder) {
  const auto pins = pinEvidence(
      recordingOf(
          {}, {{10, Signal::kEncoderA, true}, {20, Signal::kEncoderB, true}, {30, Signal::kEncoderB, false}}),
      wiringOfX());
  ASSERT_THAT(pins.belt, SizeIs(3));
  EXPECT_THAT(pins.belt[1].x_mm, DoubleEq(0.02));
  EXPECT_THAT(pins.belt[2].x_mm, DoubleEq(0.01));
  EXPECT_THAT(pins.belt[2].time_s, DoubleEq(30e-6));
}

TEST(PinEvidence, PortsWithoutSignalsAndAnEmptyRecordingSayNothing) {
  const auto pins = pinEvidence(recordingOf({{5, 900, 1, 1, 0}}), wiringOfX());
  EXPECT_EQ(pins.pulses.at(0).pulses, 0U);
  EXPECT_THAT(pins.gates, IsEmpty());
  EXPECT_THAT(pinEvidence({}, {}).belt, IsEmpty());
}

}  // namespace
}  // namespace kerfbench::evidence

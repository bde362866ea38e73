// SPDX-License-Identifier: Apache-2.0
#include "hil/run/live_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hil/machine_file/machine_file.h"
#include "hil/run/sensor_lag.h"
#include "hil/run/twin_model.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::run {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Tick kMs = 1'000'000;
constexpr TickRate kRate = source::GpioLiveSource::kRate;

twin::WebDescription web() {
  twin::WebDescription result;
  result.print.pitch_mm = 70;
  result.print.units = 2;
  result.print.eye_mark_length_mm = 4;
  result.start_x_mm = -170;
  result.belt_speed_mm_s = 60;
  result.belt_speed_changes = {{0.2, 90.0}, {0.5, 20.0}};
  return result;
}

// The edges that the live model sends ahead of the clock are those of a machine that is queried quantum by
// quantum.
TEST(LiveModelTest, SensorsAheadOfTheClockAreThoseOfTheMachine) {
  const twin::MachineDescription machine =
      machine_file::readMachine(base::fixture("machines/two-mirror.yaml"));
  LiveModel model(machine, web(), kRate, 1, false);
  EXPECT_THAT(model.highAtStart(), ElementsAre(Signal::kInterlock));
  std::vector<SensorEdge> ahead{{1, Signal::kInterlock, true}};
  for (Tick until = kMs; until <= 900 * kMs; until += kMs) {
    const std::vector<SensorEdge> edges = model.predictSensors(until);
    for (const SensorEdge& edge : edges) {
      // No edge comes before the promised time.
      EXPECT_GT(edge.tick + kMs, until);
      EXPECT_LE(edge.tick, until + kRate.ticksAt(LiveModel::kAhead_s));
    }
    ahead.insert(ahead.end(), edges.begin(), edges.end());
    model.advance(until, {});
  }
  twin::Twin twin(machine, web(), kRate, {.fidelity = twin::Fidelity::kReference});
  WitnessedTwin witnessed(twin);
  for (Tick until = kMs / 2; until <= 900 * kMs; until += kMs / 2) witnessed.advance(until, {});
  const SensorLag lag =
      sensorLag(witnessed.due(), base::SpilledVector<SensorEdge>(ahead), kRate, 900 * kMs,
                {Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark, Signal::kInterlock}, 10e-6);
  EXPECT_THAT(lag.problems, IsEmpty());
  EXPECT_GT(lag.lag.edges(), 3500U);
  EXPECT_TRUE(std::ranges::any_of(ahead, [](const SensorEdge& e) { return e.signal == Signal::kPrintMark; }));
}

// The controller drives the gantry beyond its travel.
TEST(LiveModelTest, LimitSwitchesAnswerToThePinsThatWereRead) {
  const twin::MachineDescription machine =
      machine_file::readMachine(base::fixture("machines/strip-gantry.yaml"));
  const PinId pul = machine.signals.pin(Signal::kGantryXPul).value();
  const auto mask = static_cast<std::uint16_t>(1U << pul.bit);
  twin::WebDescription at_rest = web();
  at_rest.belt_speed_mm_s = 0;
  at_rest.belt_speed_changes.clear();
  const auto limitsOf = [&](bool with_limits) {
    LiveModel model(machine, at_rest, kRate, 1, with_limits);
    std::vector<SensorEdge> told;
    for (Tick until = kMs; until <= 6000 * kMs; until += kMs) {
      for (const SensorEdge& edge : model.predictSensors(until)) {
        if (edge.signal != Signal::kLimitX && edge.signal != Signal::kLimitY) continue;
        EXPECT_GT(edge.tick + kMs, until);
        EXPECT_LE(edge.tick, until);
        told.push_back(edge);
      }
      std::vector<PinEvent> pulses;
      for (Tick at = until - kMs + 1; at < until; at += kMs / 20) {
        pulses.push_back({at, pul.port, mask, mask, 0});
        pulses.push_back({at + kMs / 40, pul.port, mask, 0, 0});
      }
      model.advance(until, pulses);
    }
    return told;
  };
  EXPECT_THAT(limitsOf(false), IsEmpty());
  const std::vector<SensorEdge> told = limitsOf(true);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0].signal, Signal::kLimitX);
  EXPECT_TRUE(told[0].level);
}

}  // namespace
}  // namespace kerfbench::run

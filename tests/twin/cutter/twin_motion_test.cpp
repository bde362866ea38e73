// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

TEST(TwinMotion, TheSpotFollowsThePulsesOfBothMirrors) {
  const auto machine = twoMirror();
  for (const auto& [x_steps, y_steps] :
       {std::pair(3000, 0), {-3000, 0}, {0, 2500}, {0, -2500}, {2000, -4000}}) {
    Pins pins(machine.signals);
    pins.steps(Signal::kGalvoXPul, 1e-3, std::abs(x_steps), 20e-6, x_steps > 0);
    pins.steps(Signal::kGalvoYPul, 1e-3, std::abs(y_steps), 20e-6, y_steps > 0);
    Twin twin(machine, lineWeb(), kRate);
    run(twin, pins.events(), 0, ticks(0.1), kQuantum);
    const double b = y_steps * kGalvoStepRad;
    const double y = 500.0 * std::tan(2.0 * b);
    const double x = (15.0 + 500.0 / std::cos(2.0 * b)) * std::tan(2.0 * x_steps * kGalvoStepRad);
    EXPECT_NEAR(twin.truth().p_WQ_mm.x(), x, 1e-9);
    EXPECT_NEAR(twin.truth().p_WQ_mm.y(), y, 1e-9);
  }
}

TEST(TwinMotion, TheSpotTrailsItsPulsesByTheTrackingDelay) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  constexpr double kPeriodS = 25e-6;
  pins.steps(Signal::kGalvoYPul, 1e-3, 2000, kPeriodS, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.045), kQuantum);
  // A pulse counts from 2.5 us after its edge; half a step is the staircase's own mean.
  const double delay_s =
      2.0 * 0.7 / std::get<ServoDescription>(machine.galvo_y.drive).natural_frequency_rad_s;
  const double angle = kGalvoStepRad * ((0.045 - delay_s - 1e-3 - 2.5e-6) / kPeriodS + 0.5);
  EXPECT_NEAR(twin.truth().p_WQ_mm.y(), 500.0 * std::tan(2.0 * angle), 0.5e-3);
}

TEST(TwinMotion, TheGantryFollowsItsPulses) {
  const auto machine = gantry();
  Pins pins(machine.signals);
  pins.steps(Signal::kGantryXPul, 1e-3, 120, 200e-6, false);
  pins.steps(Signal::kGantryYPul, 1e-3, 77, 200e-6, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.3), kQuantum);
  EXPECT_NEAR(twin.truth().p_WQ_mm.x(), -120 * kTravelStepMm, 1e-9);
  EXPECT_NEAR(twin.truth().p_WQ_mm.y(), 77 * kTravelStepMm, 1e-9);
}

TEST(TwinMotion, TheLineRunsAtItsSpeedFromTheStart) {
  Twin twin(twoMirror(), lineWeb(), kRate);
  for (Tick now = 0; now < ticks(0.5); now += kQuantum) {
    twin.advance(now + kQuantum, {});
    ASSERT_NEAR(twin.truth().belt_travel_mm, 60.0 * twin.truth().time_s, 1e-9);
  }
}

TEST(TwinMotion, FeedPulsesMoveTheBeltAndTheLineDoesNot) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  double end_s = pins.steps(Signal::kFeedPul, 1e-3, 1000, 250e-6, true);
  pins.steps(Signal::kFeedPul, end_s + 1e-3, 201, 250e-6, false);
  Twin twin(machine, fedWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.6), kQuantum);
  EXPECT_NEAR(twin.truth().belt_travel_mm, 799 * kTravelStepMm, 1e-6);
}

TEST(TwinMotion, TheEmittedEnergyIsPowerTimesDutyTimesTime) {
  const auto machine = twoMirror();
  for (const double duty : {0.05, 0.3, 1.0}) {
    Pins pins(machine.signals);
    pins.set(5e-3, Signal::kLaserGate, true);
    pins.set(55e-3, Signal::kLaserGate, false);
    constexpr double kPwmS = 64e-6;
    for (int i = 0; i < 2000; ++i) {
      pins.set(i * kPwmS, Signal::kLaserPwm, true);
      if (duty < 1.0) pins.set((i + duty) * kPwmS, Signal::kLaserPwm, false);
    }
    Twin twin(machine, lineWeb(), kRate);
    run(twin, pins.events(), 0, ticks(0.1), kQuantum);
    // The gate may cut the first and the last period of the PWM.
    const double expected_j = 100.0 * duty * 50e-3;
    EXPECT_NEAR(twin.truth().emitted_j, expected_j, duty < 1.0 ? 100.0 * kPwmS : 1e-4 * expected_j);
    EXPECT_NEAR(twin.sheet().energyJ(), twin.truth().emitted_j, 1e-3 * twin.truth().emitted_j);
  }
}

TEST(TwinMotion, WithoutTheGateThePwmBurnsNothing) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  pins.set(1e-3, Signal::kLaserPwm, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.05), kQuantum);
  EXPECT_EQ(twin.truth().emitted_j, 0.0);
  EXPECT_TRUE(twin.sheet().untouched({-1e4, -1e4}, {1e4, 1e4}));
}

TEST(TwinMotion, ASpotThatRestsBurnsALineOnTheMovingWeb) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  pins.set(10e-3, Signal::kLaserGate, true);
  pins.set(110e-3, Signal::kLaserGate, false);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.2), kQuantum);
  // The web's S is at -157 + 0.6 mm at 10 ms, so the beam at W's origin meets x_S = 156.4, and runs to 150.4.
  const double peak = std::sqrt(2.0 / M_PI) * 100.0 / 60.0 / machine.beam.waist_radius_mm;
  EXPECT_NEAR(twin.sheet().fluenceAt({153.4, 0.0}), peak, 1e-3 * peak);
  EXPECT_TRUE(twin.sheet().untouched({156.7, -1.0}, {200.0, 1.0}));
  EXPECT_TRUE(twin.sheet().untouched({100.0, -1.0}, {150.1, 1.0}));
  EXPECT_FALSE(twin.sheet().untouched({156.3, -0.1}, {156.4, 0.1}));
  EXPECT_FALSE(twin.sheet().untouched({150.4, -0.1}, {150.5, 0.1}));
}

TEST(TwinMotion, ExposuresComeEvenlyAndEachOnce) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  pins.set(10e-3, Signal::kLaserGate, true);
  Twin twin(machine, lineWeb(), kRate);
  std::vector<Exposure> exposures;
  run(twin, pins.events(), 0, ticks(0.05), kQuantum, [&](Tick, Tick, const auto&) {
    for (const Exposure& e : twin.takeExposures()) exposures.push_back(e);
  });
  ASSERT_EQ(exposures.size(), 50U);
  EXPECT_TRUE(twin.takeExposures().empty());
  for (std::size_t i = 0; i < exposures.size(); ++i) {
    const Exposure& e = exposures[i];
    EXPECT_EQ(e.sequence, i);
    EXPECT_NEAR(e.start_s, 1e-3 * static_cast<double>(i), 1e-12);
    ASSERT_EQ(e.samples.size(), 5U);
    for (std::size_t k = 0; k < 5; ++k) {
      const double mid_s = e.start_s + 10e-6 * (static_cast<double>(k) + 0.5);
      EXPECT_NEAR(e.samples[k].p_WS_mm.x(), -157.0 + 60.0 * mid_s, 1e-8);
      EXPECT_NEAR(e.samples[k].p_WQ_mm.norm(), 0.0, 1e-9);
      EXPECT_NEAR(e.samples[k].power_w, i > 10 ? 100.0 : i < 10 ? 0.0 : e.samples[k].power_w, 1e-4);
    }
  }
}

TEST(TwinMotion, AMirrorDrivenOutOfReachBurnsNothing) {
  const auto machine = twoMirror();
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  pins.steps(Signal::kGalvoXPul, 1e-3, 64000, 5e-6 * 2, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.66), kQuantum);
  EXPECT_TRUE(std::isnan(twin.truth().p_WQ_mm.x()));
  const PinEvent gate{ticks(0.66) + 1, 2, 4, 12, 0};
  twin.advance(ticks(0.7), std::span(&gate, 1));
  EXPECT_GT(twin.truth().emitted_j, 3.9);
  EXPECT_EQ(twin.sheet().energyJ(), 0.0);
}

TEST(TwinMotion, RefusesAMachineThatCannotBe) {
  auto no_feed = twoMirror();
  no_feed.belt.feed = {};
  EXPECT_THROW(Twin(no_feed, fedWeb(), kRate), std::invalid_argument);
  EXPECT_NO_THROW(Twin(no_feed, lineWeb(), kRate));
  auto light_bridge = gantry();
  light_bridge.gantry_x.load_inertia = light_bridge.gantry_y.load_inertia;
  EXPECT_THROW(Twin(light_bridge, lineWeb(), kRate), std::invalid_argument);
  auto blind = twoMirror();
  blind.spot_camera.frame_period_s = 1e-6;
  EXPECT_THROW(Twin(blind, lineWeb(), kRate), std::invalid_argument);
  auto slow_shutter = twoMirror();
  slow_shutter.spot_camera.exposure_s = 2e-3;
  EXPECT_THROW(Twin(slow_shutter, lineWeb(), kRate), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin

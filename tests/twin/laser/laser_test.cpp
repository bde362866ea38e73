// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/laser.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kStepS = 10e-6;

LaserDescription tube(double full_power_w, double rise_s, double fall_s) {
  LaserDescription laser;
  laser.full_power_w = full_power_w;
  laser.rise_time_s = rise_s;
  laser.fall_time_s = fall_s;
  return laser;
}

/// A tube with S3's kind of characteristic: nothing up to a threshold, then steep, then flat.
LaserDescription curvedTube() {
  LaserDescription laser = tube(80.0, 30e-6, 60e-6);
  laser.power_curve = {{0.0, 0.0}, {0.1, 0.0}, {0.2, 0.15}, {0.5, 0.6}, {0.8, 0.9}, {1.0, 1.0}};
  return laser;
}

TEST(Laser, StepsThatADarkTubeMissesChangeNothing) {
  Laser every(curvedTube(), 1);
  Laser lit(curvedTube(), 1);
  int missed = 0;
  for (int i = 0; i < 1000; ++i) {
    const double gate = i % 200 < 20 ? 1.0 : 0.0;
    const double duty = i % 3 == 0 ? 0.9 : 0.4;
    const double all_j = every.step(gate, duty, i * kStepS, kStepS);
    const bool dark = gate == 0.0 && lit.dark();
    missed += dark ? 1 : 0;
    EXPECT_EQ(dark ? 0.0 : lit.step(gate, duty, i * kStepS, kStepS), all_j) << i;
  }
  EXPECT_GT(missed, 100);
}

TEST(Laser, ATubeWithASmoothedDutyIsNeverDark) {
  LaserDescription laser = curvedTube();
  laser.demand_filter_s = 1e-3;
  EXPECT_FALSE(Laser(laser, 1).dark());  // The filter follows the duty while the gate is shut.
}

TEST(Laser, TheEnergyOfAStepIsTheIntegralOfThePower) {
  Laser coarse(tube(80.0, 20e-6, 45e-6), 1);
  Laser fine(tube(80.0, 20e-6, 45e-6), 1);
  const CounterRandom random(1, 1);
  double power_sum_j = 0.0;
  double coarse_j = 0.0;
  constexpr int kParts = 1000;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double demand = i % 7 < 3 ? 0.0 : random.uniform(i);
    const double begin_s = static_cast<double>(i) * kStepS;
    coarse_j += coarse.step(demand, begin_s, kStepS);
    for (int part = 0; part < kParts; ++part) {
      const double before_w = fine.power_w();
      fine.step(demand, begin_s + part * kStepS / kParts, kStepS / kParts);
      power_sum_j += 0.5 * (before_w + fine.power_w()) * kStepS / kParts;
    }
    EXPECT_NEAR(coarse.power_w(), fine.power_w(), 1e-9);
    EXPECT_NEAR(coarse_j, power_sum_j, 1e-7 * power_sum_j);
  }
}

TEST(Laser, RisesAndFallsByOneOverEInEachOfItsTimeConstants) {
  Laser laser(tube(100.0, 20e-6, 70e-6), 1);
  laser.step(1.0, 0.0, 20e-6);
  EXPECT_NEAR(laser.power_w(), 100.0 * (1.0 - std::exp(-1.0)), 1e-10);
  laser.step(1.0, 20e-6, 1.0);
  EXPECT_NEAR(laser.power_w(), 100.0, 1e-10);
  laser.step(0.3, 1.1, 70e-6);
  EXPECT_NEAR(laser.power_w(), 30.0 + 70.0 * std::exp(-1.0), 1e-10);
}

TEST(Laser, EmitsOnTheWholeWhatWasDemanded) {  // The energy that the rise withholds comes out after the gate.
  Laser laser(tube(60.0, 35e-6, 35e-6), 1);
  double energy_j = 0.0;
  for (int i = 0; i < 1000; ++i) energy_j += laser.step(i < 500 ? 0.4 : 0.0, i * kStepS, kStepS);
  EXPECT_NEAR(energy_j, 0.4 * 60.0 * 500 * kStepS, 1e-6 * energy_j);
}

// The excess is P (fall - rise), the area of the longer tail.
TEST(Laser, ASlowFallEmitsMoreThanWasDemanded) {
  Laser laser(tube(60.0, 35e-6, 85e-6), 1);
  double energy_j = 0.0;
  for (int i = 0; i < 1000; ++i) energy_j += laser.step(i < 500 ? 0.4 : 0.0, i * kStepS, kStepS);
  EXPECT_NEAR(energy_j, 0.4 * 60.0 * (500 * kStepS + 50e-6), 1e-6 * energy_j);
}

TEST(Laser, IsWhollyDarkSomeTimeAfterTheGateCloses) {
  LaserDescription description = tube(100.0, 20e-6, 20e-6);
  description.noise = 0.05;
  Laser laser(description, 1);
  laser.step(1.0, 0.0, 1e-3);
  double energy_j = 1.0;
  for (int i = 0; i < 40; ++i) energy_j = laser.step(0.0, 1e-3 + i * kStepS, kStepS);
  EXPECT_EQ(laser.power_w(), 0.0);
  EXPECT_EQ(energy_j, 0.0);
}

TEST(Laser, WithoutARiseTimeFollowsItsDemandAtOnce) {
  Laser laser(tube(50.0, 0.0, 0.0), 1);
  EXPECT_EQ(laser.step(0.5, 0.0, kStepS), 25.0 * kStepS);
  EXPECT_EQ(laser.power_w(), 25.0);
  EXPECT_EQ(laser.step(0.0, kStepS, kStepS), 0.0);
}

TEST(PowerCurve, GivesThePowerOfItsPointsAndTheLinesBetween) {
  LaserDescription description = curvedTube();
  for (const auto& [demand, share] : std::vector<PowerPoint>{{0.0, 0.0},
                                                             {0.05, 0.0},
                                                             {0.1, 0.0},
                                                             {0.15, 0.075},
                                                             {0.2, 0.15},
                                                             {0.35, 0.375},
                                                             {0.9, 0.95},
                                                             {1.0, 1.0}}) {
    Laser laser(description, 1);
    for (int i = 0; i < 300; ++i) laser.step(demand, i * kStepS, kStepS);
    EXPECT_NEAR(laser.power_w(), 80.0 * share, 1e-9) << demand;
  }
}

TEST(Supply, FollowsTheDutyNotThePulses) {
  LaserDescription description = curvedTube();
  description.rise_time_s = description.fall_time_s = 30e-6;  // A slower fall would add to the mean.
  description.demand_filter_s = 1e-3;
  Laser laser(description, 1);
  double energy_j = 0.0;
  for (int i = 0; i < 4000; ++i) {  // The PWM has 40 pulses a millisecond, duty 0.35.
    const double pulses[] = {1.0, 0.4, 0.0, 0.0};
    const double step_j = laser.step(1.0, pulses[i % 4], i * kStepS, kStepS);
    if (i >= 2000) energy_j += step_j;
  }
  EXPECT_NEAR(energy_j, 80.0 * 0.375 * 2000 * kStepS, 1e-3 * energy_j);
  // Without the filter the same pulses go through the curve one by one.
  description.demand_filter_s = 0.0;
  Laser quick(description, 1);
  double quick_j = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double pulses[] = {1.0, 0.4, 0.0, 0.0};
    const double step_j = quick.step(1.0, pulses[i % 4], i * kStepS, kStepS);
    if (i >= 2000) quick_j += step_j;
  }
  EXPECT_NEAR(quick_j, 80.0 * 0.25 * (1.0 + 0.45) * 2000 * kStepS, 1e-3 * quick_j);
}

TEST(Supply, RisesInItsTimeConstantAndItsEnergyIsTheIntegral) {
  LaserDescription description = tube(100.0, 0.0, 0.0);
  description.demand_filter_s = 200e-6;
  Laser laser(description, 1);
  double energy_j = 0.0;
  for (int i = 0; i < 20; ++i) energy_j += laser.step(1.0, 1.0, i * kStepS, kStepS);
  EXPECT_NEAR(energy_j, 100.0 * (200e-6 - 200e-6 * (1.0 - std::exp(-1.0))), 1e-12);
}

TEST(Gate, BlanksAtOnceWhateverTheFilterHolds) {
  LaserDescription description = tube(100.0, 0.0, 0.0);
  description.demand_filter_s = 5e-3;
  Laser laser(description, 1);
  double time_s = 0.0;
  for (; time_s < 0.1; time_s += 1e-3) laser.step(1.0, 0.6, time_s, 1e-3);
  EXPECT_NEAR(laser.power_w(), 60.0, 1e-5);
  EXPECT_EQ(laser.step(0.0, 0.6, time_s, kStepS), 0.0);
  EXPECT_NEAR(laser.step(1.0, 0.6, time_s + kStepS, kStepS), 60.0 * kStepS, 1e-9);
}

TEST(Gate, OpenForAShareOfTheStepGivesThatShareOfTheCurvesPower) {
  LaserDescription description = curvedTube();
  description.rise_time_s = description.fall_time_s = 0.0;
  Laser laser(description, 1);
  EXPECT_NEAR(laser.step(0.25, 0.5, 0.0, kStepS), 0.25 * 0.6 * 80.0 * kStepS, 1e-15);
}

TEST(WarmingUp, ChangesThePowerByItsDriftInTheEnd) {
  LaserDescription description = tube(100.0, 0.0, 0.0);
  description.drift = -0.04;
  description.drift_time_s = 100.0;
  Laser laser(description, 1);
  for (double time_s = 0.0; time_s < 2000.0; time_s += 0.37) {
    const double expected = 1.0 - 0.04 * (1.0 - std::exp(-time_s / 100.0));
    EXPECT_NEAR(laser.step(1.0, time_s, kStepS), 100.0 * expected * kStepS, 1e-7 * 100.0 * kStepS) << time_s;
  }
  EXPECT_NEAR(laser.step(1.0, 5000.0, kStepS), 96.0 * kStepS, 1e-12);
}

LaserDescription noisyTube() {
  LaserDescription description = tube(100.0, 0.0, 0.0);
  description.noise = 0.02;
  description.noise_correlation_s = 1e-3;
  return description;
}

TEST(Noise, IsTheSameForTheSameSeedHoweverTheTimeIsCut) {
  Laser whole(noisyTube(), 7);
  Laser cut(noisyTube(), 7);
  Laser other(noisyTube(), 8);
  double worst_j = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const double begin_s = i * kStepS;
    const double energy_j = whole.step(1.0, begin_s, kStepS);
    const double parts_j =
        cut.step(1.0, begin_s, 0.3 * kStepS) + cut.step(1.0, begin_s + 0.3 * kStepS, 0.7 * kStepS);
    EXPECT_NEAR(parts_j, energy_j, 1e-12 * energy_j);
    worst_j = std::max(worst_j, std::abs(other.step(1.0, begin_s, kStepS) - energy_j));
  }
  EXPECT_GT(worst_j, 0.02 * 100.0 * kStepS);
}

TEST(Noise, DoesNotDependOnWhenTheLaserWasLit) {
  Laser always(noisyTube(), 7);
  Laser late(noisyTube(), 7);
  for (int i = 0; i < 3000; ++i) {
    const double begin_s = i * kStepS;
    const bool lit = i % 1000 > 700;
    const double always_j = always.step(1.0, begin_s, kStepS);
    const double late_j = late.step(lit ? 1.0 : 0.0, begin_s, kStepS);
    EXPECT_EQ(late_j, lit ? always_j : 0.0);
  }
}

TEST(Laser, AnswersTheSameWhateverItWasAskedBetween) {
  Laser steps(curvedTube(), 1);
  Laser mixed(curvedTube(), 1);
  double steps_j = 0.0, mixed_j = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double duty = i % 20 < 12 ? 0.7 : 0.0;
    steps_j += steps.step(duty, i * kStepS, kStepS);
    for (int part = 0; part <= i % 3; ++part) {
      const double part_s = kStepS / (1 + i % 3);
      mixed_j += mixed.step(duty, i * kStepS + part * part_s, part_s);
    }
  }
  EXPECT_NEAR(mixed_j, steps_j, 1e-12 * steps_j);
}

TEST(LaserDescription, AllFaultsAreNamedAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(faultsOf(LaserDescription{}), "");
  EXPECT_EQ(faultsOf(curvedTube()), "");
  EXPECT_EQ(faultsOf(noisyTube()), "");
  LaserDescription laser;
  laser.full_power_w = 0.0;
  laser.rise_time_s = nan;
  laser.fall_time_s = -1e-6;
  laser.gate_delay_s = nan;
  laser.power_curve = {{0.0, 0.0}, {0.5, 0.7}, {0.6, 0.6}, {1.0, 1.0}};
  laser.demand_filter_s = std::numeric_limits<double>::infinity();
  laser.noise = 0.5;
  laser.noise_correlation_s = 0.0;
  laser.drift = -1.0;
  laser.drift_time_s = nan;
  const std::string faults = faultsOf(laser);
  for (const char* name :
       {"full_power_w", "rise_time_s", "fall_time_s", "gate_delay_s", "power_curve", "demand_filter_s",
        "noise must", "noise_correlation_s", "drift must", "drift_time_s"}) {
    EXPECT_NE(faults.find(name), std::string::npos) << name;
  }
  EXPECT_THROW(Laser(laser, 1), std::invalid_argument);
}

TEST(LaserDescription, APowerCurveMustGoFromZeroToOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto faulty = [](std::vector<PowerPoint> curve) {
    LaserDescription laser;
    laser.power_curve = std::move(curve);
    return !faultsOf(laser).empty();
  };
  EXPECT_FALSE(faulty({{0.0, 0.0}, {1.0, 1.0}}));
  EXPECT_FALSE(faulty({{0.0, 0.0}, {0.2, 0.0}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.0, 0.0}}));
  EXPECT_TRUE(faulty({{0.0, 0.1}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.1, 0.0}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.0, 0.0}, {1.0, 0.9}}));
  EXPECT_TRUE(faulty({{0.0, 0.0}, {0.5, 0.5}, {0.5, 0.6}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.0, 0.0}, {nan, 0.5}, {1.0, 1.0}}));
  EXPECT_TRUE(faulty({{0.0, 0.0}, {0.5, nan}, {1.0, 1.0}}));
}

}  // namespace
}  // namespace kerfbench::twin

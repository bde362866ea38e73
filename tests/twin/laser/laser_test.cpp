// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/laser.h"

#include <cmath>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kStepS = 10e-6;

TEST(Laser, TheEnergyOfAStepIsTheIntegralOfThePower) {
  Laser coarse({80.0, 20e-6});
  Laser fine({80.0, 20e-6});
  const CounterRandom random(1, 1);
  double power_sum_j = 0.0;
  double coarse_j = 0.0;
  constexpr int kParts = 1000;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double demand = i % 7 < 3 ? 0.0 : random.uniform(i);
    coarse_j += coarse.step(demand, kStepS);
    for (int part = 0; part < kParts; ++part) {
      const double before_w = fine.power_w();
      fine.step(demand, kStepS / kParts);
      power_sum_j += 0.5 * (before_w + fine.power_w()) * kStepS / kParts;
    }
    EXPECT_NEAR(coarse.power_w(), fine.power_w(), 1e-9);
    EXPECT_NEAR(coarse_j, power_sum_j, 1e-7 * power_sum_j);
  }
}

TEST(Laser, RisesAndFallsByOneOverEInItsTimeConstant) {
  Laser laser({100.0, 20e-6});
  laser.step(1.0, 20e-6);
  EXPECT_NEAR(laser.power_w(), 100.0 * (1.0 - std::exp(-1.0)), 1e-10);
  laser.step(1.0, 1.0);
  EXPECT_NEAR(laser.power_w(), 100.0, 1e-10);
  laser.step(0.0, 20e-6);
  EXPECT_NEAR(laser.power_w(), 100.0 * std::exp(-1.0), 1e-10);
}

TEST(Laser, EmitsOnTheWholeWhatWasDemanded) {  // What the rise withholds comes out after the gate.
  Laser laser({60.0, 35e-6});
  double energy_j = 0.0;
  for (int i = 0; i < 500; ++i) energy_j += laser.step(0.4, kStepS);
  for (int i = 0; i < 500; ++i) energy_j += laser.step(0.0, kStepS);
  EXPECT_NEAR(energy_j, 0.4 * 60.0 * 500 * kStepS, 1e-6 * energy_j);
}

TEST(Laser, IsWhollyDarkSomeTimeAfterTheGateCloses) {
  Laser laser({100.0, 20e-6});
  laser.step(1.0, 1e-3);
  double energy_j = 1.0;
  for (int i = 0; i < 40; ++i) energy_j = laser.step(0.0, kStepS);
  EXPECT_EQ(laser.power_w(), 0.0);
  EXPECT_EQ(energy_j, 0.0);
}

TEST(Laser, WithoutARiseTimeFollowsItsDemandAtOnce) {
  Laser laser({50.0, 0.0});
  EXPECT_EQ(laser.step(0.5, kStepS), 25.0 * kStepS);
  EXPECT_EQ(laser.power_w(), 25.0);
  EXPECT_EQ(laser.step(0.0, kStepS), 0.0);
}

}  // namespace
}  // namespace kerfbench::twin

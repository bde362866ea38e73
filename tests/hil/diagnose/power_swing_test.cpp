// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "hil/diagnose/power_swing.h"

namespace kerfbench::diagnose {
namespace {

constexpr double kSpeed_mm_s = 100.0;

/// A second of one cut; `light` and `speed` by time.
PowerRun run(const std::function<double(double)>& light, const std::function<double(double)>& speed) {
  PowerRun of;
  for (int i = 0; i < 2000; ++i) {
    const double time_s = i * kPowerSpan_s;
    of.light_share.push_back(light(time_s));
    of.speed_mm_s.push_back(speed(time_s));
  }
  return of;
}
double even(double) { return kSpeed_mm_s; }

TEST(PowerSwing, FindsAmplitudeAndPeriod) {
  for (const double period_s : {0.004, 0.009, 0.02}) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.02);
    const auto light = [&](double t) {
      return 0.4 * (1.0 + 0.3 * std::sin(2.0 * std::numbers::pi * t / period_s) + noise(random));
    };
    const auto swing = powerSwing({run(light, even)});
    ASSERT_TRUE(swing) << period_s;
    EXPECT_NEAR(swing->share, 0.3, swing->share_U);
    EXPECT_LT(swing->share_U, 0.1);
    EXPECT_NEAR(swing->period_s, period_s, kPowerSpan_s);
  }
}

TEST(PowerSwing, NoiseIsNone) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.15);
  EXPECT_FALSE(powerSwing({run([&](double) { return 0.4 * (1.0 + noise(random)); }, even)}));
}

TEST(PowerSwing, PowerThatFollowsTheSpeedIsNone) {
  // Corners each 40 ms, at which the beam slows down to half and its power with it, a little late.
  const auto speed = [](double t) {
    const double since_s = std::fmod(t, 0.04);
    return kSpeed_mm_s * (since_s < 0.01 ? 0.5 + 50.0 * std::abs(since_s - 0.005) * 2.0 : 1.0);
  };
  EXPECT_FALSE(powerSwing({run([&](double t) { return 0.004 * speed(t - 0.001); }, speed)}));
}

TEST(PowerSwing, ThePwmItselfIsNone) {
  // 1 kHz, looked at each half millisecond: bright and dark in turn.
  EXPECT_FALSE(powerSwing({run([](double t) { return std::fmod(t, 0.001) < 0.00049 ? 1.0 : 0.2; }, even)}));
}

TEST(PowerSwing, ASmallOneAndAShortOneAreNone) {
  const auto light = [](double share) {
    return [share](double t) { return 0.4 * (1.0 + share * std::sin(2.0 * std::numbers::pi * t / 0.009)); };
  };
  EXPECT_FALSE(powerSwing({run(light(0.04), even)}));
  EXPECT_TRUE(powerSwing({run(light(0.08), even)}));
  PowerRun brief = run(light(0.3), even);
  brief.light_share.resize(120);  // 60 ms: six periods.
  EXPECT_FALSE(powerSwing({brief}));
  EXPECT_FALSE(powerSwing({}));
}

TEST(PowerSwing, ADarkLaserAndABeamAtRestAreNone) {
  EXPECT_FALSE(powerSwing({run([](double) { return 0.0; }, even)}));
  EXPECT_FALSE(powerSwing(
      {run([](double t) { return std::fmod(t, 0.01) < 0.005 ? 1.0 : 0.0; }, [](double) { return 0.0; })}));
}

}  // namespace
}  // namespace kerfbench::diagnose

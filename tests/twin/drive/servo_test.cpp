// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/servo.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

constexpr double kStepS = 10e-6;
constexpr double kInertia = 5e-7;

ServoDescription galvo(double feedforward) {
  ServoDescription servo;
  servo.natural_frequency_rad_s = 2.0 * std::numbers::pi * 1200.0;
  servo.damping = 0.7;
  servo.velocity_feedforward = feedforward;
  return servo;
}

// A free inertia behind the servo, by the same position Verlet as the machine.
struct Axis {
  Servo servo;
  double q{}, qd{}, a{};
  void step(double mean_command) {
    const double q_mid = q + 0.5 * kStepS * qd;
    a = servo.torque(mean_command, q_mid, qd + 0.5 * kStepS * a, kStepS) / kInertia;
    qd += kStepS * a;
    q = q_mid + 0.5 * kStepS * qd;
  }
};

// How far behind a ramp the axis is in the end, as a time.
double delayOfRamp(const ServoDescription& description) {
  constexpr double kSpeed = 0.6;
  Axis axis{Servo(description, kInertia)};
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) axis.step(kSpeed * (i + 0.5) * kStepS);
  return (kSpeed * kSteps * kStepS - axis.q) / kSpeed;
}

TEST(Servo, TrailsARampByTwoZetaOverItsFrequency) {
  for (const double zeta : {0.5, 0.7, 1.2}) {
    ServoDescription servo = galvo(0.0);
    servo.damping = zeta;
    const double expected_s = 2.0 * zeta / servo.natural_frequency_rad_s;
    EXPECT_NEAR(delayOfRamp(servo), expected_s, 0.01 * expected_s);
  }
}

TEST(Servo, FullFeedforwardFollowsARampWithoutDelay) {
  EXPECT_NEAR(delayOfRamp(galvo(1.0)), 0.0, 1e-9);
  const double half_s = 0.7 / galvo(0.5).natural_frequency_rad_s;
  EXPECT_NEAR(delayOfRamp(galvo(0.5)), half_s, 0.01 * half_s);
}

TEST(Servo, NeverGivesMoreThanItsTorque) {
  ServoDescription servo = galvo(0.0);
  servo.max_torque = 0.02;
  Servo limited(servo, kInertia);
  EXPECT_EQ(limited.torque(1.0, 0.0, 0.0, kStepS), 0.02);
  EXPECT_EQ(limited.torque(-1.0, 0.0, 0.0, kStepS), -0.02);
  const double wn = servo.natural_frequency_rad_s;
  EXPECT_NEAR(limited.torque(1e-4, 0.0, 0.0, kStepS), kInertia * wn * wn * 1e-4, 1e-12);
}

TEST(Servo, SettlesOnAConstantCommand) {
  Axis axis{Servo(galvo(1.0), kInertia)};
  for (int i = 0; i < 3000; ++i) axis.step(0.01);
  EXPECT_NEAR(axis.q, 0.01, 1e-12);
  EXPECT_NEAR(axis.qd, 0.0, 1e-9);
}

TEST(Servo, ResetOnAMovingCommandStartsWithoutAJolt) {
  constexpr double kSpeed = 0.6;
  Axis axis{Servo(galvo(1.0), kInertia)};
  axis.qd = kSpeed;
  axis.servo.reset(-0.5 * kSpeed * kStepS, kSpeed);  // The mean command of the step before the first.
  for (int i = 0; i < 100; ++i) {
    axis.step(kSpeed * (i + 0.5) * kStepS);
    EXPECT_NEAR(axis.qd, kSpeed, 1e-12);
  }
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/twin/machine/rigs.h"

namespace kerfbench::twin {
namespace {

constexpr double kInertia = 5e-7;

class Servo : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Servo, testing::ValuesIn(kSolvers));

// Largest error of a step of 20 mrad at 1500 Hz, zeta 0.7, against the solution in closed form, rad.
double errorOfStep(Solve solve, double step_s) {
  constexpr double kZeta = 0.7;
  constexpr double kTarget = 0.02;
  const ServoDescription servo = servoOf(1500.0, kZeta);
  const auto solver = solverOf(driven(servo, kInertia), solve, step_s);
  const double wn = servo.natural_frequency_rad_s;
  const double wd = wn * std::sqrt(1.0 - kZeta * kZeta);
  double worst = 0.0;
  const auto each = [&](double t) {
    const double swing = std::cos(wd * t) + kZeta * wn / wd * std::sin(wd * t);
    const double exact = kTarget * (1.0 - std::exp(-kZeta * wn * t) * swing);
    worst = std::max(worst, std::abs(solver->q()[0] - exact));
  };
  run(
      *solver, 1, 0.0, 3e-3, [](double) { return kTarget; }, each, step_s);
  return worst;
}

TEST_P(Servo, AStepFollowsTheClosedForm) {
  // 1 nrad is 1 nm in the work plane at 500 mm.
  EXPECT_LT(errorOfStep(GetParam(), kStep_s), GetParam() == Solve::kFast ? 1e-13 : 12e-9);
  if (GetParam() == Solve::kFast) return;
  EXPECT_LT(errorOfStep(GetParam(), 5e-6), 1e-9);
  EXPECT_NEAR(errorOfStep(GetParam(), kStep_s) / errorOfStep(GetParam(), 5e-6), 16.0, 2.0);
}

// Final lag of the axis behind a ramp, as a time.
double delayOfRamp(const ServoDescription& servo, Solve solve) {
  constexpr double kSpeed = 0.6;
  constexpr double kTime_s = 0.02;
  const auto solver = solverOf(driven(servo, kInertia), solve);
  run(*solver, 1, 0.0, kTime_s, [](double t) { return kSpeed * t; });
  return kTime_s - solver->q()[0] / kSpeed;
}

TEST_P(Servo, TrailsARampByTwoZetaOverItsFrequency) {
  for (const double zeta : {0.5, 0.7, 1.2}) {
    const ServoDescription servo = servoOf(1200.0, zeta);
    EXPECT_NEAR(delayOfRamp(servo, GetParam()), 2.0 * zeta / servo.natural_frequency_rad_s, 1e-10);
  }
}

TEST_P(Servo, FeedforwardTakesItsShareOfTheDelay) {
  EXPECT_NEAR(delayOfRamp(servoOf(1200.0, 0.7, 1.0), GetParam()), 0.0, 1e-10);
  const ServoDescription half = servoOf(1200.0, 0.7, 0.5);
  EXPECT_NEAR(delayOfRamp(half, GetParam()), 0.7 / half.natural_frequency_rad_s, 1e-10);
}

TEST_P(Servo, GivesNoMoreThanItsTorque) {
  ServoDescription servo = servoOf(1200.0, 0.7);
  servo.max_torque = 0.01;
  const auto solver = solverOf(driven(servo, kInertia), GetParam());
  // The torque is at its limit at the begin of a large step: a parabola.
  run(
      *solver, 1, 0.0, 200e-6, [](double) { return 0.3; },
      [&](double t) { ASSERT_NEAR(solver->q()[0], 0.5 * 0.01 / kInertia * t * t, 1e-12); });
  run(*solver, 1, 200e-6, 0.1, [](double) { return 0.3; });
  EXPECT_NEAR(solver->q()[0], 0.3, 1e-12);
}

TEST_P(Servo, SlewsNoFasterThanItsSpeed) {
  ServoDescription servo = servoOf(200.0, 0.7);
  servo.max_speed = 50.0;
  const auto solver = solverOf(driven(servo, kInertia), GetParam());
  double fastest = 0.0;
  double at_10_ms = 0.0;
  run(
      *solver, 1, 0.0, 0.03, [](double) { return 1.0; },
      [&](double t) {
        fastest = std::max(fastest, solver->v()[0]);
        if (std::abs(t - 0.01) < 1e-9) at_10_ms = solver->q()[0];
        if (std::abs(t - 0.015) < 1e-9) {
          EXPECT_NEAR(solver->q()[0] - at_10_ms, 50.0 * 5e-3, 1e-6);
        }
      });
  EXPECT_LT(fastest, 50.0 * (1.0 + 1e-9));
  EXPECT_NEAR(solver->q()[0], 1.0, 1e-4);
}

TEST_P(Servo, TheCurrentComesWithItsLag) {
  ServoDescription servo = servoOf(1200.0, 0.7);
  servo.max_torque = 0.01;
  servo.current_lag_s = 50e-6;
  const auto solver = solverOf(driven(servo, kInertia), GetParam());
  run(
      *solver, 1, 0.0, 200e-6, [](double) { return 0.3; },
      [&](double t) {
        const double lag_s = 50e-6;
        const double gained = t - lag_s * (1.0 - std::exp(-t / lag_s));
        ASSERT_NEAR(solver->v()[0], 0.01 / kInertia * gained, 2e-5);
      });
}

TEST_P(Servo, AnElasticLoadRingsAtItsOwnFrequency) {
  // The motor and the mirror are free: kicked against each other they swing at sqrt(k (1/Jm + 1/Jl)).
  MechanismDescription description;
  description.joints = {rotorOf("motor", 3e-7), rotorOf("mirror", 2e-7)};
  const double w = 2.0 * std::numbers::pi * 4000.0;
  const double reduced = 1.2e-7;
  description.couplings = {{1, 1.0, 0, -1.0, reduced * w * w, 2.0 * 0.01 * reduced * w, 0.0, 0.0}};
  description.joints[0].start_speed = 2.0;
  description.joints[1].start_speed = -3.0;  // The initial momentum is zero.
  const auto solver = solverOf(description, GetParam());
  double worst = 0.0;
  const double wd = w * std::sqrt(1.0 - 1e-4);
  run(*solver, 2e-3, [&](double t) {
    const double exact = -5.0 / wd * std::exp(-0.01 * w * t) * std::sin(wd * t);
    worst = std::max(worst, std::abs(solver->q()[1] - solver->q()[0] - exact));
  });
  EXPECT_LT(worst, GetParam() == Solve::kFast ? 1e-13 : 5.0 / w * 2e-3);
  EXPECT_NEAR(3e-7 * solver->v()[0] + 2e-7 * solver->v()[1], 0.0, 1e-16);
}

TEST_P(Servo, ALoadBehindPlayStaysUntilThePlayIsThrough) {
  // The motor moves slowly there and back; friction holds the load meanwhile.
  constexpr double kPlay = 2e-3;
  MechanismDescription description = driven(servoOf(300.0, 0.7), 3e-7);
  description.joints.push_back(rotorOf("load", 2e-7));
  CouplingDescription gear{1, 1.0, 0, -0.5, 20.0, 1e-4, kPlay, 0.0};
  description.couplings = {gear};
  JointFriction friction;
  friction.joint = 1;
  friction.friction = {2e-4, 1e-6, 1e-5};
  description.frictions = {friction};
  const auto solver = solverOf(description, GetParam());
  const auto command = [](double t) { return t < 0.1 ? 0.2 * t : 0.04 - 0.2 * t; };
  double forth = 0.0;
  run(*solver, 1, 0.0, 0.2, command, [&](double t) {
    if (std::abs(t - 0.08) < 1e-9) forth = solver->q()[1] - 0.5 * solver->q()[0];
  });
  const double back = solver->q()[1] - 0.5 * solver->q()[0];
  const double wind = (2e-4 + 1e-6 * 0.1) / 20.0;  // Winding of the shaft by the friction.
  EXPECT_NEAR(forth, -(0.5 * kPlay + wind), 1e-7);
  EXPECT_NEAR(back, 0.5 * kPlay + wind, 1e-7);
}

}  // namespace
}  // namespace kerfbench::twin

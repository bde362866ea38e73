// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/twin/machine/rigs.h"

namespace kerfbench::twin {
namespace {

constexpr double kInertia = 8e-5;  // Inertia of rotor and load.
constexpr double kFullStep = 2.0 * std::numbers::pi / 200.0;

class Stepper : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Stepper, testing::ValuesIn(kSolvers));

StepperDescription nema23() {
  StepperDescription stepper;
  stepper.holding_torque_nm = 1.2;
  stepper.damping_nm_s = 4e-3;
  stepper.rated_current_a = 4.0;
  stepper.resistance_ohm = 0.6;
  stepper.inductance_h = 2e-3;
  return stepper;
}

double settledLag(const StepperDescription& stepper, double load_nm, Solve solve) {
  StepperDescription damped = stepper;
  damped.damping_nm_s = 0.1;
  MechanismDescription description = driven(damped, kInertia);
  description.constant_forces = {{0, load_nm}};
  const auto solver = solverOf(description, solve);
  run(*solver, 1, 0.0, 0.1, {});
  return solver->q()[0];
}

TEST_P(Stepper, GivesWayByTheSineOfItsLoad) {
  for (const double share : {-0.9, 0.1, 0.5, 0.95}) {
    EXPECT_NEAR(settledLag(nema23(), 1.2 * share, GetParam()), std::asin(share) / 50.0, 1e-9);
  }
}

TEST_P(Stepper, IsPulledFromToothToToothBeyondItsHoldingTorque) {
  MechanismDescription description = driven(nema23(), kInertia);
  description.constant_forces = {{0, 1.1 * 1.2}};
  const auto solver = solverOf(description, GetParam());
  run(*solver, 1, 0.0, 0.1, {});
  EXPECT_GT(solver->q()[0], 10 * 4.0 * kFullStep);
}

TEST_P(Stepper, DetentPullsTowardsFullSteps) {
  StepperDescription stepper = nema23();
  stepper.detent_torque_nm = 0.06;
  stepper.damping_nm_s = 0.1;
  const auto solver = solverOf(driven(stepper, kInertia), GetParam());
  run(*solver, 1, 0.0, 0.2, [](double) { return 0.25 * kFullStep; });
  // Rest position by bisection of the balance of field and detent.
  double low = 0.0;
  double high = 0.25 * kFullStep;
  for (int i = 0; i < 60; ++i) {
    const double q = 0.5 * (low + high);
    const double torque = -1.2 * std::sin(50.0 * (q - 0.25 * kFullStep)) - 0.06 * std::sin(200.0 * q);
    (torque > 0 ? low : high) = q;
  }
  EXPECT_NEAR(solver->q()[0], low, 1e-9);
  EXPECT_LT(low, 0.249 * kFullStep);
}

TEST_P(Stepper, ASmallSwingHasTheFrequencyOfItsMagneticSpring) {
  StepperDescription stepper = nema23();
  stepper.damping_nm_s = 0.0;
  const double amplitude = 0.005 * kFullStep;
  const auto solver = solverOf(driven(stepper, kInertia), GetParam());
  const double w = std::sqrt(1.2 * 50.0 / kInertia);
  double worst = 0.0;
  run(
      *solver, 1, 0.0, 0.05, [&](double) { return amplitude; },
      [&](double t) {
        worst = std::max(worst, std::abs(solver->q()[0] - amplitude * (1.0 - std::cos(w * t))));
      });
  EXPECT_LT(worst, 5e-4 * amplitude);  // The sine is softer than its tangent.
}

// Rotor with the equation of the header, written anew, by Runge-Kutta in fine steps with the same mean
// commands.
class FineRotor {
 public:
  explicit FineRotor(const StepperDescription& stepper) : d_(stepper) {}
  double q{}, v{};

  void advance(double command, double span_s) {
    constexpr int kParts = 10;
    const double h = span_s / kParts;
    for (int i = 0; i < kParts; ++i) {
      const double a1 = acceleration(q, v, command);
      const double a2 = acceleration(q + 0.5 * h * v, v + 0.5 * h * a1, command);
      const double v2 = v + 0.5 * h * a1;
      const double a3 = acceleration(q + 0.5 * h * v2, v + 0.5 * h * a2, command);
      const double v3 = v + 0.5 * h * a2;
      const double v4 = v + h * a3;
      const double a4 = acceleration(q + h * v3, v4, command);
      q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }

 private:
  [[nodiscard]] double acceleration(double at, double speed, double command) const {
    double field = d_.holding_torque_nm;
    if (std::isfinite(d_.supply_v)) {
      const double w = std::abs(speed);
      const double back_v = d_.holding_torque_nm / d_.rated_current_a * w;
      const double impedance = std::hypot(d_.resistance_ohm, 50.0 * w * d_.inductance_h);
      field *= std::min(1.0, std::max(0.0, d_.supply_v - back_v) / (impedance * d_.rated_current_a));
    }
    const double torque = -field * std::sin(50.0 * (at - command)) - d_.damping_nm_s * speed -
                          d_.detent_torque_nm * std::sin(200.0 * at);
    return torque / kInertia;
  }
  StepperDescription d_;
};

// Command of a ramp to a speed and down again in sixteenths of a step, as area means over the solver's steps.
double rampCommand(double t, double speed, double acceleration) {
  const double ramp_s = speed / acceleration;
  constexpr double kRun_s = 0.05;
  if (t < ramp_s) return 0.5 * acceleration * t * t;
  if (t < ramp_s + kRun_s) return 0.5 * speed * ramp_s + speed * (t - ramp_s);
  const double left = std::max(0.0, 2.0 * ramp_s + kRun_s - t);
  return speed * (ramp_s + kRun_s) - 0.5 * acceleration * left * left;
}
double staircase(double t, double speed, double acceleration) {
  constexpr double kMicrostep = kFullStep / 16.0;
  return kMicrostep * std::floor(rampCommand(t, speed, acceleration) / kMicrostep + 0.5);
}

class StepperRamp : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, StepperRamp, testing::Values(Solve::kReference, Solve::kFast));

TEST_P(StepperRamp, LosesTheSameStepsAsAnIndependentFineIntegration) {
  StepperDescription stepper = nema23();
  stepper.supply_v = 36.0;
  stepper.detent_torque_nm = 0.04;
  int lost_ramps = 0;
  int kept_ramps = 0;
  for (const double acceleration : {2e3, 8e3, 1.2e4, 1.7e4, 2.5e4}) {
    for (const double speed : {40.0, 70.0, 110.0}) {
      const auto solver = solverOf(driven(stepper, kInertia), GetParam());
      FineRotor fine(stepper);
      const double end_s = 2.0 * speed / acceleration + 0.05 + 0.03;
      double worst = 0.0;
      const long long steps = std::llround(end_s / kStep_s);
      double last = 0.0;
      for (long long i = 0; i < steps; ++i) {
        const double begin_s = static_cast<double>(i) * kStep_s;
        // The staircase is arbitrary, as long as both see the same.
        last = staircase(begin_s + 0.5 * kStep_s, speed, acceleration);
        const DriveCommand command{last, last, last};
        solver->step(begin_s, {&command, 1});
        fine.advance(last, kStep_s);
        worst = std::max(worst, std::abs(solver->q()[0] - fine.q));
      }
      const double tooth = 4.0 * kFullStep;
      const long long lost = std::llround((last - solver->q()[0]) / tooth);
      EXPECT_EQ(lost, std::llround((last - fine.q) / tooth)) << acceleration << " rad/s² to " << speed;
      ++(lost == 0 ? kept_ramps : lost_ramps);
      // The travel is 40 mm a turn: 1 um is 157 urad.
      if (lost == 0) {
        EXPECT_LT(worst, 20e-6) << acceleration << " rad/s² to " << speed;
      }
    }
  }
  EXPECT_GE(lost_ramps, 4);
  EXPECT_GE(kept_ramps, 4);
}

}  // namespace
}  // namespace kerfbench::twin

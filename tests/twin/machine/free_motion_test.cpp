// SPDX-License-Identifier: Apache-2.0
// Motions with a solution in closed form, or a conserved quantity, by all solvers.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/twin/machine/rigs.h"

namespace kerfbench::twin {
namespace {

class FreeMotion : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, FreeMotion, testing::ValuesIn(kSolvers));

MechanismDescription oscillator(double inertia, double frequency_hz, double zeta) {
  MechanismDescription description;
  description.joints = {rotorOf("rotor", inertia)};
  const double w = 2.0 * std::numbers::pi * frequency_hz;
  CouplingDescription spring;
  spring.stiffness = inertia * w * w;
  spring.damping = 2.0 * zeta * inertia * w;
  description.couplings = {spring};
  return description;
}

TEST_P(FreeMotion, AnUndampedOscillatorKeepsItsEnergyForAThousandPeriods) {
  const double w = 2.0 * std::numbers::pi * 1200.0;
  MechanismDescription description = oscillator(5e-7, 1200.0, 0.0);
  description.joints[0].start_speed = 0.02 * w;
  const auto solver = solverOf(description, GetParam());
  double least = 1e9;
  double most = 0.0;
  run(*solver, 1000.0 / 1200.0, [&](double) {
    const double energy = 0.5 * (std::pow(solver->v()[0], 2) + std::pow(w * solver->q()[0], 2));
    least = std::min(least, energy);
    most = std::max(most, energy);
  });
  const double start = 0.5 * std::pow(0.02 * w, 2);
  // Runge-Kutta loses (wh)^6 / 72 of the energy a step, 2e-4 in all; the exact flow nothing.
  const double loss = GetParam() == Solve::kFast ? 1e-9 : 3e-4;
  EXPECT_LT(most / start - 1.0, 1e-9);
  EXPECT_GT(least / start - 1.0, -loss);
}

TEST_P(FreeMotion, ADampedOscillatorFollowsTheExactSolution) {
  for (const double zeta : {0.01, 0.7}) {
    const double w = 2.0 * std::numbers::pi * 1200.0;
    MechanismDescription description = oscillator(5e-7, 1200.0, zeta);
    description.joints[0].start_speed = 0.02 * w;
    const auto solver = solverOf(description, GetParam());
    const double wd = w * std::sqrt(1.0 - zeta * zeta);
    double worst = 0.0;
    run(*solver, 3e-3, [&](double t) {
      const double exact = 0.02 * w / wd * std::exp(-zeta * w * t) * std::sin(wd * t);
      worst = std::max(worst, std::abs(solver->q()[0] - exact));
    });
    EXPECT_LT(worst, GetParam() == Solve::kFast ? 1e-13 : 0.02 * 3e-5);
  }
}

TEST_P(FreeMotion, GravityPullsWhatIsNotLevel) {
  // The joints are a slope of 30 degrees, and a level slide on top of it.
  MechanismDescription description;
  description.joints = {slideOf("slope", 4.0, -1, {std::sqrt(0.75), 0.0, 0.5}),
                        slideOf("level", 1.0, 0, Eigen::Vector3d::UnitY())};
  description.joints[0].start_speed = 2.0;
  const auto solver = solverOf(description, GetParam());
  constexpr double kG_m_s2 = 9.80665;
  run(*solver, 0.5, [&](double t) { ASSERT_NEAR(solver->q()[0], 2.0 * t - 0.25 * kG_m_s2 * t * t, 1e-11); });
  EXPECT_EQ(solver->q()[1], 0.0);
}

TEST_P(FreeMotion, AConstantForceGivesAParabola) {
  MechanismDescription description;
  description.joints = {slideOf("slide", 4.0)};
  description.joints[0].start_speed = -0.3;
  description.constant_forces = {{0, 6.0}};
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.5, [&](double t) { ASSERT_NEAR(solver->q()[0], -0.3 * t + 0.75 * t * t, 1e-12); });
  EXPECT_NEAR(solver->v()[0], -0.3 + 0.75, 1e-12);
}

TEST_P(FreeMotion, NothingBrakesWhatRunsFree) {
  MechanismDescription description;
  description.joints = {rotorOf("roller", 2e-3), slideOf("belt", 0.5), rotorOf("galvo", 5e-7)};
  description.joints[0].start_speed = 66.0;
  description.joints[1].start_speed = 2.0;
  description.joints[2].start_speed = 870.0;
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.2);
  EXPECT_NEAR(solver->v()[0], 66.0, 1e-9);
  EXPECT_NEAR(solver->v()[1], 2.0, 1e-11);
  EXPECT_NEAR(solver->v()[2], 870.0, 1e-8);
  EXPECT_NEAR(solver->q()[2], 174.0, 1e-8);
}

// A frame, and a bridge with a leaning carriage on it, each tied to its carrier by a spring.
MechanismDescription gantryOnFrame() {
  MechanismDescription description;
  description.joints = {slideOf("frame.x", 0.0), slideOf("frame.y", 300.0, 0, Eigen::Vector3d::UnitY()),
                        slideOf("bridge", 9.0, 1),
                        slideOf("carriage", 3.0, 2, Eigen::Vector3d(-0.1, 1.0, 0.0).normalized())};
  description.joints[2].start_speed = 0.7;
  description.joints[3].start_speed = -0.4;
  description.couplings = {{2, 1.0, std::nullopt, 0.0, 2e5, 50.0, 0.0, 0.0},
                           {3, 1.0, std::nullopt, 0.0, 1e5, 10.0, 0.0, 0.0}};
  return description;
}

TEST_P(FreeMotion, AFrameWithoutFeetKeepsTheMomentumOfAllThatItCarries) {
  const MechanismDescription description = gantryOnFrame();
  const auto solver = solverOf(description, GetParam());
  const Eigen::Vector3d lean = description.joints[3].axis;
  const auto momentum = [&] {
    const auto v = solver->v();
    const Eigen::Vector3d frame(v[0], v[1], 0.0);
    const Eigen::Vector3d bridge = frame + Eigen::Vector3d(v[2], 0.0, 0.0);
    return Eigen::Vector3d(300.0 * frame + 9.0 * bridge + 3.0 * (bridge + v[3] * lean));
  };
  const Eigen::Vector3d start(12.0 * 0.7 - 0.4 * 3.0 * lean.x(), -0.4 * 3.0 * lean.y(), 0.0);
  double furthest = 0.0;
  run(*solver, 0.2, [&](double) {
    ASSERT_LT((momentum() - start).norm(), 1e-10);
    furthest = std::max(furthest, std::abs(solver->q()[0]));
  });
  EXPECT_GT(furthest, 1e-3);  // The frame did move.
}

TEST_P(FreeMotion, FeetBearTheReactionOfWhatIsPushed) {
  MechanismDescription description = gantryOnFrame();
  description.couplings = {{0, 1.0, std::nullopt, 0.0, 2e7, 1.5e5, 0.0, 0.0}};
  description.joints[2].start_speed = description.joints[3].start_speed = 0.0;
  description.joints[3].axis = Eigen::Vector3d::UnitY();
  description.constant_forces = {{2, 24.0}};  // The force acts between frame and bridge: 2 m/s² of 12 kg.
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.2);
  EXPECT_NEAR(solver->q()[0], -24.0 / 2e7, 1e-11);
  EXPECT_NEAR(solver->v()[2] / 0.2, 2.0, 1e-2);
}

TEST_P(FreeMotion, TheSameStepsGiveTheSameBits) {
  const auto end = [&] {
    const auto solver = solverOf(gantryOnFrame(), GetParam());
    run(*solver, 0.02);
    return std::vector<double>(solver->q().begin(), solver->q().end());
  };
  EXPECT_EQ(end(), end());
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/twin/machine/rigs.h"
#include "twin/machine/fast_solver.h"

namespace kerfbench::twin {
namespace {

class Friction : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Friction, testing::ValuesIn(kSolvers));

// A slide of 2 kg with 10 N of dry friction, pushed by a constant force.
MechanismDescription pushed(double force_n) {
  MechanismDescription description;
  description.joints = {slideOf("slide", 2.0)};
  JointFriction friction;
  friction.friction.coulomb = 10.0;
  description.frictions = {friction};
  description.constant_forces = {{0, force_n}};
  return description;
}

TEST_P(Friction, HoldsLikeASpringBelowItsLimit) {
  const auto solver = solverOf(pushed(6.0), GetParam());
  run(*solver, 0.1);
  EXPECT_NEAR(solver->q()[0], 0.6e-6, 1e-12);
  EXPECT_NEAR(solver->v()[0], 0.0, 1e-9);
}

TEST_P(Friction, BreaksLooseAtItsLimitAndSlidesWithIt) {
  const auto held = solverOf(pushed(5.0), GetParam());
  run(*held, 0.2);
  EXPECT_LT(held->q()[0], 1e-6);
  const auto loose = solverOf(pushed(10.1), GetParam());
  run(*loose, 0.1);
  const double v_early = loose->v()[0];
  run(*loose, 0, 0.1, 0.2, {});
  EXPECT_NEAR((loose->v()[0] - v_early) / 0.1, 0.1 / 2.0, 1e-9);
}

TEST_P(Friction, ASlidingBodyStopsWhereItsEnergyIsSpent) {
  MechanismDescription description = pushed(0.0);
  description.constant_forces.clear();
  description.joints[0].start_speed = 0.5;
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.3);
  EXPECT_NEAR(solver->v()[0], 0.0, 1e-9);
  // The difference is within the give of the bristle.
  EXPECT_NEAR(solver->q()[0], 0.5 * 2.0 * 0.25 / 10.0, 2e-6);
}

TEST_P(Friction, ViscousFrictionBrakesInProportion) {
  MechanismDescription description = pushed(8.0);
  description.frictions[0].friction = {0.0, 40.0, 1e-6};
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.05);
  EXPECT_NEAR(solver->v()[0], 8.0 / 40.0 * (1.0 - std::exp(-40.0 / 2.0 * 0.05)), 1e-9);
}

TEST_P(Friction, ASheetOnABeltThatIsTooFastGainsSpeedByFrictionAlone) {
  for (const double share : {0.7, 1.5, 4.0}) {
    MechanismDescription description = sheetOnBelt();
    // The force would move both with `share` of the acceleration that friction can give the sheet.
    const double can = kGrip_n / kSheet_kg;
    const double force_n =
        share > 1 ? kBelt_kg * share * can + kGrip_n : (kBelt_kg + kSheet_kg) * share * can;
    description.constant_forces = {{0, force_n}};
    const auto solver = solverOf(description, GetParam());
    constexpr double kTime_s = 0.1;
    run(*solver, kTime_s);
    const double sheet_m_s = solver->v()[0] + solver->v()[1];
    if (share < 1) {
      EXPECT_LT(std::abs(solver->q()[1]), 1e-6);
      EXPECT_NEAR(sheet_m_s, share * can * kTime_s, 1e-6);
    } else {
      EXPECT_NEAR(sheet_m_s / (can * kTime_s), 1.0, 2e-3);  // The speed is less while the bristle stretches.
      EXPECT_NEAR(solver->v()[0] / (share * can * kTime_s), 1.0, 2e-3);
      EXPECT_LT(solver->q()[1], -1e-3);
    }
    EXPECT_EQ(solver->q()[2], 0.0);
  }
}

TEST_P(Friction, APulledSheetSlidesWhereItIsPulledWithOneLimitForBothDirections) {
  MechanismDescription description = sheetOnBelt();
  const Eigen::Vector2d pull(0.6 * 1.2 * kGrip_n, 0.8 * 1.2 * kGrip_n);
  description.constant_forces = {{0, pull.x()}, {1, pull.x()}, {2, pull.y()}};
  description.joints[0].mass_kg = 1e6;  // The belt stays.
  const auto solver = solverOf(description, GetParam());
  constexpr double kTime_s = 0.05;
  run(*solver, kTime_s);
  const Eigen::Vector2d speed(solver->v()[1], solver->v()[2]);
  EXPECT_NEAR(speed.y() / speed.x(), 0.8 / 0.6, 1e-3);
  EXPECT_NEAR(speed.norm(), 0.2 * kGrip_n / kSheet_kg * kTime_s, 0.05 * speed.norm());
}

TEST_P(Friction, ADragThatAlreadySlidesAcrossLowersTheGripAlong) {
  // The sheet is pulled at right angles with the limit's force each: together they are more than the limit,
  // and the sheet moves equally in both directions.
  MechanismDescription description = sheetOnBelt();
  description.joints[0].mass_kg = 1e6;
  description.constant_forces = {{0, 0.8 * kGrip_n}, {1, 0.8 * kGrip_n}, {2, 0.8 * kGrip_n}};
  const auto solver = solverOf(description, GetParam());
  run(*solver, 0.05);
  EXPECT_GT(solver->q()[1], 1e-4);
  EXPECT_NEAR(solver->q()[1], solver->q()[2], 1e-6 * solver->q()[1] + 1e-9);
}

// A belt that shakes below the limit, with a drag on its sheet.
MechanismDescription shaken() {
  MechanismDescription description = sheetOnBelt();
  CouplingDescription spring;
  // One second has whole periods: means are those of the middle.
  const double w = 2.0 * std::numbers::pi * 50.0;
  spring.stiffness = (kBelt_kg + kSheet_kg) * w * w;
  description.couplings = {spring};
  description.joints[0].start_speed = 0.005;
  description.constant_forces = {{0, -0.5 * kGrip_n}, {1, -0.5 * kGrip_n}};
  description.frictions[0].start_load = -0.5 * kGrip_n;
  return description;
}

TEST(FrictionFast, AStuckSheetDoesNotCreepInTenSeconds) {
  const auto solver = solverOf(shaken(), Solve::kFast);
  std::vector<double> means;
  for (int second = 0; second < 10; ++second) {
    double sum = 0.0;
    run(*solver, 0, second, second + 1, {}, [&](double) { sum += solver->q()[1]; });
    means.push_back(sum * kStep_s);
  }
  for (const double mean : means) EXPECT_NEAR(mean, means.front(), 1e-10) << "m";
  EXPECT_LT(std::abs(means.back()), 1e-6);
}

TEST_P(Friction, AStuckSheetComesBackToItsPlace) {
  const auto solver = solverOf(shaken(), GetParam());
  double widest = 0.0;
  double sum = 0.0;
  run(*solver, 0.4, [&](double t) {
    widest = std::max(widest, std::abs(solver->q()[1]));
    if (t > 0.2) sum += solver->q()[1];
  });
  EXPECT_GT(widest, 1e-8);  // The joint was shaken.
  EXPECT_LT(std::abs(sum * kStep_s / 0.2), 1e-9);
}

TEST(FrictionFast, OnlyStepsWithAKinkAreHalved) {
  const auto mechanism = std::make_shared<const Mechanism>(pushed(12.0));
  FastSolver solver(mechanism, kStep_s);
  run(solver, 0.5);
  EXPECT_EQ(solver.halved(), 1U);  // The joint breaks loose once.
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/mechanism.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/twin/machine/rigs.h"
#include "twin/machine/divergence.h"
#include "twin/machine/mechanism_part.h"

namespace kerfbench::twin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const MechanismDescription& description) {
  try {
    const Mechanism mechanism(description);
    mechanism.requireSlowerThan(kStep_s);
  } catch (const std::invalid_argument& fault) {
    return fault.what();
  }
  return "";
}

TEST(Mechanism, NamesEverythingThatIsWrong) {
  EXPECT_EQ(refusal(sheetOnBelt()), "");
  MechanismDescription bad = sheetOnBelt();
  bad.frictions[0].friction.presliding = 0.0;
  bad.joints[0].mass_kg = -1.0;
  bad.couplings = {{0, 1.0, 7, 1.0, 0.0, -1.0, 0.0, 0.0}};
  ServoDescription servo = servoOf(100.0, 9.0);
  servo.max_torque = std::nan("");
  bad.drives = driven(servo, 1e-6).drives;
  const std::string all = refusal(bad);
  for (const char* part : {"sheet.x: presliding", "belt: mass", "belt: coupled to no joint",
                           "belt: stiffness", "drive: damping", "drive: max torque"}) {
    EXPECT_THAT(all, HasSubstr(part));
  }
}

TEST(Mechanism, RefusesAJointThatMovesNoMass) {
  MechanismDescription bad = sheetOnBelt();
  bad.joints[2].mass_kg = 0.0;
  EXPECT_THAT(refusal(bad), HasSubstr("moves no mass"));
}

TEST(Mechanism, RefusesWhatIsTooFastForTheStepAndNamesTheJoint) {
  MechanismDescription stiff;
  stiff.joints = {rotorOf("motor", 1e-3), rotorOf("feather", 1e-9)};
  stiff.couplings = {{1, 1.0, 0, -1.0, 11.0, 0.0, 0.0, 0.0}};  // 105 krad/s
  EXPECT_THAT(refusal(stiff), HasSubstr("feather"));
  stiff.couplings[0].stiffness = 9.0;
  EXPECT_EQ(refusal(stiff), "");
  stiff.couplings[0].stiffness = 11.0;
  stiff.couplings[0].play = 1e-3;  // A play is as stiff as its flanks.
  EXPECT_THAT(refusal(stiff), HasSubstr("feather"));
}

TEST(Mechanism, ItsForcesJoinAtTheirKinks) {
  // A state a little to either side of each kink gives nearly the same force.
  MechanismDescription description = driven(servoOf(500.0, 0.7, 1.0), 3e-7);
  auto& servo = std::get<ServoDescription>(description.drives[0].drive);
  servo.max_speed = 40.0;
  servo.max_torque = 0.01;
  description.joints.push_back(rotorOf("load", 2e-7));
  description.couplings = {{1, 1.0, 0, -1.0, 50.0, 1e-3, 2e-3, 0.0}};
  JointFriction friction;
  friction.joint = 1;
  friction.friction = {1e-3, 0.0, 1e-5};
  description.frictions = {friction};
  const Mechanism mechanism(description);
  const ForceLaw& law = mechanism.law();
  ASSERT_EQ(law.stateSize(), 6U);
  std::vector<double> x(6, 0.0);
  std::vector<double> force(2);
  std::vector<double> rate(2);
  const double u = 0.0;
  for (std::size_t changed = 0; changed < 6; ++changed) {
    const double range[] = {0.05, 2e-3, 60.0, 5.0, 2e-5, 0.05};
    constexpr int kPoints = 20000;
    std::vector<double> before;
    double span = 0.0;
    double jump = 0.0;
    std::vector<double> low;
    for (int i = 0; i <= kPoints; ++i) {
      x.assign(6, 0.0);
      x[changed] = range[changed] * (2.0 * i / kPoints - 1.0);
      law.evaluate(x.data(), &u, force.data(), rate.data());
      for (std::size_t k = 0; k < 2 && !before.empty(); ++k) {
        jump = std::max(jump, std::abs(force[k] - before[k]));
        span = std::max(span, std::abs(force[k] - low[k]));
      }
      before = force;
      if (low.empty()) low = force;
    }
    EXPECT_LT(jump, 0.01 * span + 1e-18) << "state " << changed;
  }
}

TEST(Mechanism, TheAffinePiecesAreTheForceLaw) {
  MechanismDescription description = sheetOnBelt();
  description.couplings = {{0, 1.0, std::nullopt, 0.0, 2e5, 30.0, 1e-4, 0.0}};
  const Mechanism mechanism(description);
  const ForceLaw& law = mechanism.law();
  std::vector<double> x{0.3e-3, 1e-7, -2e-7, 0.02, 1e-4, 2e-4, 3e-7, -1e-7};
  std::vector<ForceLaw::Piece> pieces(law.pieceCount());
  for (const auto& [speed, piece] : {std::pair(0.02, 1), std::pair(30.0, 2)}) {
    x[3] = speed;
    law.observe(x.data(), nullptr, pieces.data());
    ASSERT_THAT(pieces, ElementsAre(piece, 0));
    const AffineRate affine = affineRate(law, mechanism.inverseMass(), pieces.data());
    std::vector<double> force(3);
    std::vector<double> rate(2);
    law.evaluate(x.data(), nullptr, force.data(), rate.data());
    const Eigen::VectorXd all = affine.A * Eigen::Map<Eigen::VectorXd>(x.data(), 8) + affine.c;
    const Eigen::Vector3d a = mechanism.inverseMass() * Eigen::Map<Eigen::Vector3d>(force.data());
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(all[i], x[static_cast<std::size_t>(3 + i)]);
      EXPECT_NEAR(all[3 + i], a[i], 1e-12 * a.norm());
    }
    EXPECT_NEAR(all[6], rate[0], 1e-12);
    EXPECT_NEAR(all[7], rate[1], 1e-12);
  }
}

TEST(MechanismParts, AreWhatNothingTiesTogetherWithoutWhatNeverMoves) {
  MechanismDescription description = driven(servoOf(500.0, 0.7), 3e-7);
  description.joints.push_back(rotorOf("idle", 1e-6));
  description.joints.push_back(rotorOf("load", 2e-7));
  for (const JointDescription& joint : sheetOnBelt().joints) {
    description.joints.push_back(joint);
    if (joint.parent >= 0) description.joints.back().parent += 3;
  }
  description.couplings = {{2, 1.0, 0, -1.0, 50.0, 0.0, 0.0, 0.0}};
  description.frictions = sheetOnBelt().frictions;
  description.frictions[0].joint = 4;
  description.frictions[0].across = 5;
  description.joints[3].start_speed = 0.2;
  description.constant_forces = {{3, 1.0}};
  const std::vector<MechanismPart> parts = partsOf(Mechanism(description));
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_THAT(parts[0].joints, ElementsAre(0, 2));
  EXPECT_THAT(parts[0].drives, ElementsAre(0));
  // The sheet can slip along the belt, but nothing pulls it across.
  ASSERT_THAT(parts[1].joints, ElementsAre(3, 4));
  EXPECT_TRUE(parts[1].drives.empty());
  EXPECT_FALSE(parts[1].law.frictions[0].plane);
  EXPECT_EQ(parts[1].start[2], 0.2);
}

class Divergence : public testing::TestWithParam<Solve> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Divergence, testing::ValuesIn(kSolvers));

TEST_P(Divergence, NamesTheJointAndTheTime) {
  MechanismDescription description;
  description.joints = {slideOf("calm", 1.0), slideOf("runaway", 1.0)};
  description.joints[1].most_speed = 2.0;
  description.constant_forces = {{1, 10.0}};
  const auto solver = solverOf(description, GetParam());
  try {
    run(*solver, 1.0);
    FAIL() << "nothing was thrown";
  } catch (const DivergenceError& error) {
    EXPECT_EQ(error.joint(), "runaway");
    EXPECT_NEAR(error.time_s(), 0.2, 2e-5);
  }
}

TEST_P(Divergence, OfManyStepsAtOnceTheFirstIsNamed) {
  MechanismDescription description;
  description.joints = {slideOf("late", 1.0), slideOf("early", 1.0), slideOf("calm", 1.0)};
  description.joints[0].most_speed = 3.0;
  description.joints[1].most_speed = 2.0;
  description.constant_forces = {{0, 10.0}, {1, 10.0}};
  const auto solver = solverOf(description, GetParam());
  try {
    solver->run(0.0, 100'000, {});
    FAIL() << "nothing was thrown";
  } catch (const DivergenceError& error) {
    EXPECT_EQ(error.joint(), "early");
    EXPECT_NEAR(error.time_s(), 0.2, 2e-5);
  }
}

TEST_P(Divergence, ACommandThatIsNoNumberIsOne) {
  const auto solver = solverOf(driven(servoOf(500.0, 0.7), 3e-7), GetParam());
  run(*solver, 1, 0.0, 1e-3, [](double) { return 0.01; });
  EXPECT_THROW(run(*solver, 1, 1e-3, 2e-3, [](double) { return std::nan(""); }), DivergenceError);
}

TEST_P(Divergence, AnUnstableLoopIsFound) {
  // The current loop is slower than the position loop: it swings up without end.
  ServoDescription servo = servoOf(1000.0, 0.3);
  servo.current_lag_s = 1e-3;
  const auto solver = solverOf(driven(servo, 3e-7), GetParam());
  EXPECT_THROW(run(*solver, 1, 0.0, 1.0, [](double) { return 0.01; }), DivergenceError);
}

}  // namespace
}  // namespace kerfbench::twin

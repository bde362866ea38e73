// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/multibody.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Kind = JointDescription::Kind;
using Eigen::Vector3d;

JointDescription rotor(double inertia_kg_m2, const Vector3d& axis = -Vector3d::UnitZ()) {
  return {"rotor", Kind::kRevolute, -1, {0.0, -0.015, 0.5}, axis, 0.01, inertia_kg_m2};
}

std::vector<JointDescription> gantry(double bridge_kg, double carriage_kg) {
  return {{"bridge", Kind::kPrismatic, -1, {0.0, 0.0, 0.3}, Vector3d::UnitX(), bridge_kg, 0.1},
          {"carriage", Kind::kPrismatic, 0, {0.1, 0.2, -0.05}, Vector3d::UnitY(), carriage_kg, 0.1}};
}

std::vector<double> accelerations(Multibody& body, const std::vector<double>& q, const std::vector<double>& v,
                                  const std::vector<double>& force) {
  std::vector<double> result(body.size());
  body.accelerations(q, v, force, result);
  return result;
}

std::vector<double> fromRest(Multibody& body, const std::vector<double>& force) {
  const std::vector<double> zero(body.size(), 0.0);
  return accelerations(body, zero, zero, force);
}

TEST(Multibody, TheBridgeCarriesTheCarriage) {
  Multibody body(gantry(9.0, 3.0));
  const std::vector<double> x = fromRest(body, {24.0, 0.0});
  EXPECT_NEAR(x[0], 24.0 / 12.0, 1e-12);
  EXPECT_NEAR(x[1], 0.0, 1e-12);
  const std::vector<double> y = fromRest(body, {0.0, 24.0});
  EXPECT_NEAR(y[0], 0.0, 1e-12);
  EXPECT_NEAR(y[1], 24.0 / 3.0, 1e-12);
}

TEST(Multibody, ASlideThatLeansPushesItsBridgeBack) {
  auto joints = gantry(9.0, 3.0);
  const double lean = 0.2;
  joints[1].axis = Vector3d(-std::sin(lean), std::cos(lean), 0.0);
  Multibody body(joints);
  const std::vector<double> a = fromRest(body, {0.0, 24.0});
  // Without a force along x the common centre of mass stays where it is along x.
  EXPECT_NEAR(12.0 * a[0] - 3.0 * std::sin(lean) * a[1], 0.0, 1e-12);
  EXPECT_NEAR(3.0 * (a[1] - std::sin(lean) * a[0]), 24.0, 1e-12);
}

TEST(Multibody, ThePoseOfTheCarriageIsTheSumOfItsSlides) {
  Multibody body(gantry(9.0, 3.0));
  const std::vector<double> q{0.25, -0.4};
  EXPECT_LT((body.pose(q, 0).translation() - Vector3d(0.25, 0.0, 0.3)).norm(), 1e-14);
  EXPECT_LT((body.pose(q, 1).translation() - Vector3d(0.35, -0.2, 0.25)).norm(), 1e-14);
  EXPECT_TRUE(body.pose(q, 1).linear().isIdentity(1e-14));
}

TEST(Multibody, ARotorTurnsByItsAngleAboutItsAxisInItsPlace) {
  for (const Vector3d& axis : {Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0.6, 0.0, 0.8)}) {
    Multibody body({rotor(5e-7, axis)});
    const std::vector<double> q{0.37};
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(0.37, axis).toRotationMatrix();
    EXPECT_LT((body.pose(q, 0).linear() - expected).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((body.pose(q, 0).translation() - Vector3d(0.0, -0.015, 0.5)).norm(), 1e-14);
  }
}

TEST(Multibody, AnInertiaOfANanokilogramSquareMetreStillMovesAsItShould) {
  Multibody body({rotor(1e-9)});
  EXPECT_NEAR(fromRest(body, {1e-6})[0], 1000.0, 1e-6);
}

TEST(Multibody, NothingBrakesABeltOrAGalvo) {
  Multibody body({{"roller", Kind::kRevolute, -1, {0.5, 0.0, -0.03}, Vector3d::UnitY(), 5.0, 2e-3},
                  {"belt", Kind::kPrismatic, -1, {0.0, 0.0, 0.0}, Vector3d::UnitX(), 0.5, 0.1},
                  rotor(5e-7)});
  const std::vector<double> a = accelerations(body, {1.0, 2.0, 0.3}, {66.0, 2.0, 870.0}, {0.0, 0.0, 0.0});
  for (const double each : a) EXPECT_EQ(each, 0.0);
}

TEST(Multibody, GravityDoesNotMoveAHorizontalSlideButDropsAVerticalOne) {
  auto joints = gantry(9.0, 3.0);
  joints.push_back({"lift", Kind::kPrismatic, 1, {0, 0, 0}, Vector3d::UnitZ(), 0.5, 0.1});
  Multibody body(joints);
  const std::vector<double> a = fromRest(body, {0.0, 0.0, 0.0});
  EXPECT_NEAR(a[0], 0.0, 1e-12);
  EXPECT_NEAR(a[1], 0.0, 1e-12);
  EXPECT_NEAR(a[2], -9.80665, 1e-10);
}

TEST(Multibody, APendulumSwingsWithTheTermsOfItsVelocity) {
  // A slide on a rotor about Wy at speed w is thrown out with w² r.
  Multibody body({{"arm", Kind::kRevolute, -1, {0, 0, 0}, Vector3d::UnitZ(), 1.0, 0.1},
                  {"bead", Kind::kPrismatic, 0, {0, 0, 0}, Vector3d::UnitX(), 0.2, 1e-6}});
  const double w = 7.0;
  const double r = 0.3;
  const std::vector<double> a = accelerations(body, {0.4, r}, {w, 0.5}, {0.0, 0.0});
  EXPECT_NEAR(a[1], w * w * r, 1e-9);
  const double inertia = 0.1 + 1e-6 + 0.2 * r * r;
  EXPECT_NEAR(a[0], -2.0 * 0.2 * r * 0.5 * w / inertia, 1e-9);
}

TEST(Multibody, DeltasAreWhatMoreForceAddsInTheSameConfiguration) {
  std::vector<JointDescription> joints = gantry(9.0, 3.0);
  joints[1].axis = Vector3d(-0.1, 1.0, 0.0).normalized();
  joints.push_back(rotor(3e-7));
  joints.back().parent = 1;
  joints.push_back({"lift", Kind::kPrismatic, 1, {0, 0, 0}, Vector3d::UnitZ(), 0.5, 0.1});
  Multibody body(joints);
  const std::vector<double> q{0.1, -0.2, 0.7, 0.05};
  const std::vector<double> v{1.0, -2.0, 50.0, 0.1};
  const std::vector<double> more{11.0, -5.0, 2e-4, 3.0};
  std::vector<double> both{3.0, 4.0, -1e-4, 1.0};
  const std::vector<double> before = accelerations(body, q, v, both);
  std::vector<double> delta(4);
  body.accelerationDeltas(more, delta);
  for (std::size_t i = 0; i < 4; ++i) both[i] += more[i];
  const std::vector<double> after = accelerations(body, q, v, both);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(delta[i], after[i] - before[i], 1e-12 * (1.0 + std::abs(after[i]))) << i;
    EXPECT_NE(delta[i], 0.0);
  }
}

TEST(Multibody, TheInverseMassMatrixTurnsForcesIntoAccelerations) {
  Multibody body(gantry(9.0, 3.0));
  const Eigen::MatrixXd inverse = inverseMassMatrix(body);
  EXPECT_NEAR(inverse(0, 0), 1.0 / 12.0, 1e-15);
  EXPECT_NEAR(inverse(1, 1), 1.0 / 3.0, 1e-15);
  EXPECT_EQ(inverse(0, 1), 0.0);
  EXPECT_EQ(inverse(1, 0), 0.0);
}

TEST(Multibody, TheSameQuestionGetsTheSameBitsWhateverWasAskedBetween) {
  Multibody body(gantry(9.0, 3.0));
  const auto ask = [&] { return accelerations(body, {0.1, 0.2}, {0.3, 0.4}, {5.0, 6.0}); };
  const std::vector<double> first = ask();
  (void)body.pose(std::vector<double>{0.7, 0.8}, 1);
  (void)fromRest(body, {1.0, -1.0});
  EXPECT_EQ(ask(), first);
}

TEST(Multibody, RefusesAParentThatComesAfterItsChildAndMassesThatCannotBe) {
  auto joints = gantry(9.0, 3.0);
  joints[0].parent = 1;
  EXPECT_THROW(Multibody{joints}, std::invalid_argument);
  EXPECT_THROW(Multibody{gantry(-1.0, 3.0)}, std::invalid_argument);
  EXPECT_THROW(Multibody{{rotor(0.0)}}, std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin

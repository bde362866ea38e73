// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/multibody.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Kind = JointDescription::Kind;
using Eigen::Vector3d;

JointDescription rotor(double inertia_kg_m2, const Vector3d& axis = -Vector3d::UnitZ()) {
  return {Kind::kRevolute, -1, {0.0, -0.015, 0.5}, axis, 0.01, inertia_kg_m2};
}

std::vector<JointDescription> gantry(double bridge_kg, double carriage_kg) {
  return {{Kind::kPrismatic, -1, {0.0, 0.0, 0.3}, Vector3d::UnitX(), bridge_kg, 0.1},
          {Kind::kPrismatic, 0, {0.1, 0.2, -0.05}, Vector3d::UnitY(), carriage_kg, 0.1}};
}

// Largest error of a rotor on a spring against the solution in closed form, over 3 ms.
double oscillatorError(double zeta, double step_s) {
  constexpr double kInertia = 5e-7;
  constexpr double kStart = 0.02;
  const double wn = 2.0 * 3.14159265358979 * 1200.0;
  Multibody body({rotor(kInertia)});
  body.setState(0, kStart, 0.0);
  const double wd = wn * std::sqrt(1.0 - zeta * zeta);
  double worst = 0.0;
  const int steps = static_cast<int>(std::lround(3e-3 / step_s));
  for (int i = 1; i <= steps; ++i) {
    body.step(step_s, [&](auto q, auto qd, auto torque) {
      torque[0] = -kInertia * (wn * wn * q[0] + 2.0 * zeta * wn * qd[0]);
    });
    const double t = i * step_s;
    const double exact = kStart * std::exp(-zeta * wn * t) *
                         (std::cos(wd * t) + zeta / std::sqrt(1.0 - zeta * zeta) * std::sin(wd * t));
    worst = std::max(worst, std::abs(body.q()[0] - exact));
  }
  return worst;
}

TEST(Multibody, AnOscillatorFollowsTheExactSolutionWithTheSecondOrderOfTheStep) {
  for (const double zeta : {0.0, 0.2, 0.7}) {
    const double coarse = oscillatorError(zeta, 10e-6);
    const double middle = oscillatorError(zeta, 5e-6);
    const double fine = oscillatorError(zeta, 2.5e-6);
    EXPECT_NEAR(coarse / middle, 4.0, 0.3) << zeta;
    EXPECT_NEAR(middle / fine, 4.0, 0.15) << zeta;
    EXPECT_LT(fine, 0.02 * 1e-3) << zeta;
  }
}

TEST(Multibody, AnUndampedOscillatorKeepsItsSwingForAThousandPeriods) {
  const double wn = 2.0 * 3.14159265358979 * 1200.0;
  Multibody body({rotor(5e-7)});
  body.setState(0, 0.02, 0.0);
  double widest = 0.0;
  for (int i = 0; i < 84000; ++i) {
    body.step(10e-6, [&](auto q, auto, auto torque) { torque[0] = -5e-7 * wn * wn * q[0]; });
    if (i > 83000) widest = std::max(widest, std::abs(body.q()[0]));
  }
  EXPECT_NEAR(widest, 0.02, 0.02 * 2e-3);
}

TEST(Multibody, TheBridgeCarriesTheCarriage) {
  Multibody body(gantry(9.0, 3.0));
  const std::vector<double> x = body.accelerations(std::vector<double>{24.0, 0.0});
  EXPECT_NEAR(x[0], 24.0 / 12.0, 1e-12);
  EXPECT_NEAR(x[1], 0.0, 1e-12);
  const std::vector<double> y = body.accelerations(std::vector<double>{0.0, 24.0});
  EXPECT_NEAR(y[0], 0.0, 1e-12);
  EXPECT_NEAR(y[1], 24.0 / 3.0, 1e-12);
}

TEST(Multibody, ThePoseOfTheCarriageIsTheSumOfItsSlides) {
  Multibody body(gantry(9.0, 3.0));
  body.setState(0, 0.25, 0.0);
  body.setState(1, -0.4, 0.0);
  EXPECT_LT((body.pose(0).translation() - Vector3d(0.25, 0.0, 0.3)).norm(), 1e-14);
  EXPECT_LT((body.pose(1).translation() - Vector3d(0.35, -0.2, 0.25)).norm(), 1e-14);
  EXPECT_TRUE(body.pose(1).linear().isIdentity(1e-14));
}

TEST(Multibody, ARotorTurnsByItsAngleAboutItsAxisInItsPlace) {
  for (const Vector3d& axis : {Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0.6, 0.0, 0.8)}) {
    Multibody body({rotor(5e-7, axis)});
    body.setState(0, 0.37, 0.0);
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(0.37, axis).toRotationMatrix();
    EXPECT_LT((body.pose(0).linear() - expected).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((body.pose(0).translation() - Vector3d(0.0, -0.015, 0.5)).norm(), 1e-14);
  }
}

TEST(Multibody, AnInertiaOfANanokilogramSquareMetreStillMovesAsItShould) {
  Multibody body({rotor(1e-9)});
  EXPECT_NEAR(body.accelerations(std::vector<double>{1e-6})[0], 1000.0, 1e-6);
  for (int i = 0; i < 100; ++i) body.step(10e-6, [](auto, auto, auto torque) { torque[0] = 1e-6; });
  EXPECT_NEAR(body.qd()[0], 1.0, 1e-9);
  // The very first step starts without a past, but a constant torque needs none.
  EXPECT_NEAR(body.q()[0], 0.5e-3, 1e-12);
}

TEST(Multibody, NothingBrakesABeltOrLimitsAGalvo) {
  Multibody body({{Kind::kRevolute, -1, {0.5, 0.0, -0.03}, Vector3d::UnitY(), 5.0, 2e-3}, rotor(5e-7)});
  body.setState(0, 0.0, 66.0);
  body.setState(1, 0.0, 870.0);
  for (int i = 0; i < 100000; ++i)
    body.step(10e-6, [](auto, auto, auto torque) { torque[0] = torque[1] = 0; });
  EXPECT_NEAR(body.qd()[0], 66.0, 1e-9);
  EXPECT_NEAR(body.q()[0], 66.0, 1e-7);
  EXPECT_NEAR(body.qd()[1], 870.0, 1e-8);
}

TEST(Multibody, GravityDoesNotMoveAHorizontalSlideButDropsAVerticalOne) {
  auto joints = gantry(9.0, 3.0);
  joints.push_back({Kind::kPrismatic, 1, {0, 0, 0}, Vector3d::UnitZ(), 0.5, 0.1});
  Multibody body(joints);
  const std::vector<double> a = body.accelerations(std::vector<double>(3, 0.0));
  EXPECT_NEAR(a[0], 0.0, 1e-12);
  EXPECT_NEAR(a[1], 0.0, 1e-12);
  EXPECT_NEAR(a[2], -9.80665, 1e-10);
}

TEST(Multibody, TheSameStepsGiveTheSameBits) {
  const auto run = [] {
    Multibody body(gantry(9.0, 3.0));
    for (int i = 0; i < 2000; ++i) {
      body.step(10e-6, [i](auto q, auto qd, auto torque) {
        torque[0] = 50.0 * std::sin(0.01 * i) - 3.0 * qd[0];
        torque[1] = 20.0 * std::cos(0.013 * i) - 100.0 * q[1];
      });
    }
    return std::vector<double>{body.q()[0], body.q()[1], body.qd()[0], body.qd()[1]};
  };
  EXPECT_EQ(run(), run());
}

TEST(Multibody, LookingAtAccelerationsOrPosesDoesNotChangeTheMotion) {
  const auto run = [](bool look) {
    Multibody body({rotor(5e-7), rotor(4e-7, Vector3d::UnitX())});
    for (int i = 0; i < 500; ++i) {
      body.step(10e-6, [](auto q, auto qd, auto torque) {
        torque[0] = 1e-4 - 0.03 * q[0] - 1e-6 * qd[0];
        torque[1] = 2e-4 - 0.02 * q[1];
      });
      if (look) {
        (void)body.pose(1);
        (void)body.accelerations(std::vector<double>{0.1, -0.1});
      }
    }
    return std::pair(body.q()[0], body.q()[1]);
  };
  EXPECT_EQ(run(false), run(true));
}

TEST(Multibody, RefusesAParentThatComesAfterItsChild) {
  auto joints = gantry(9.0, 3.0);
  joints[0].parent = 1;
  EXPECT_THROW(Multibody{joints}, std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin

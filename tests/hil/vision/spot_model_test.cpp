// SPDX-License-Identifier: Apache-2.0
// Light of a spot: its parameters compared with sums and differences of the light itself.
#include "hil/vision/spot/spot_model.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::vision {
namespace {

using Vector = SpotParameters::Vector;

struct Case {
  const char* name;
  SpotShape shape;
  Vector q;
};

Vector parameters(double a, double b, double c) {
  Vector q;
  q << 20.3, 18.6, a, b, c, 120.0, 40.0, -30.0;
  return q;
}

std::vector<Case> cases() {
  return {{"round bell", SpotShape::kBell, parameters(0.25, 0.0, 0.25)},
          {"bell askew", SpotShape::kBell, parameters(0.3, -0.11, 0.16)},
          {"streak along x", SpotShape::kStreak, parameters(6.0, 0.0, 0.5)},
          {"streak askew", SpotShape::kStreak, parameters(-3.5, 5.0, 0.6)}};
}

TEST(SpotModel, MomentsAreThoseOfTheLight) {
  for (const Case& one : cases()) {
    double sum = 0.0;
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    // The step is a quarter of a pixel: sums of smooth light are integrals.
    for (double r = -10.0; r < 50.0; r += 0.25) {
      for (double c = -10.0; c < 50.0; c += 0.25) {
        const double light = spotLight(one.shape, one.q, c, r, 0.0).bell;
        const Eigen::Vector2d d(c - one.q[0], r - one.q[1]);
        sum += light;
        first += light * d;
        second += light * d * d.transpose();
      }
    }
    EXPECT_LT((first / sum).norm(), 1e-6) << one.name;
    EXPECT_LT((second / sum - momentsOf(one.shape, one.q)).norm(), 1e-4) << one.name;
  }
}

TEST(SpotModel, DerivativesAreThoseOfFiniteDifferences) {
  for (const Case& one : cases()) {
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(20, 18), Eigen::Vector2d(23, 17),
                                         Eigen::Vector2d(17, 21), Eigen::Vector2d(21, 15)}) {
      constexpr double kCover = 0.3;
      const auto value = [&](const Vector& q) {
        return spotLight(one.shape, q, pixel.x(), pixel.y(), kCover).value;
      };
      Vector derivative;
      EXPECT_EQ(spotLight(one.shape, one.q, pixel.x(), pixel.y(), kCover, derivative).value, value(one.q));
      for (Eigen::Index k = 0; k < SpotParameters::kCount; ++k) {
        const Vector h = 1e-5 * Vector::Unit(k);
        const double slope = (value(one.q + h) - value(one.q - h)) / 2e-5;
        EXPECT_NEAR(derivative[k], slope, 1e-5 * (1.0 + std::abs(slope))) << one.name << " by " << k;
      }
    }
  }
}

TEST(SpotModel, AStreakLikeABellHasItsMomentsAndItsLight) {
  const Vector bell = parameters(0.3, -0.11, 0.16);
  const Vector streak = streakLike(bell);
  EXPECT_LT((momentsOf(SpotShape::kStreak, streak) - momentsOf(SpotShape::kBell, bell)).norm(), 1e-9);
  const auto lightOf = [](SpotShape shape, const Vector& q) {
    double sum = 0.0;
    for (double r = -10.0; r < 50.0; r += 0.5) {
      for (double c = -10.0; c < 50.0; c += 0.5) sum += 0.25 * q[5] * spotLight(shape, q, c, r, 0.0).bell;
    }
    return sum;
  };
  EXPECT_NEAR(lightOf(SpotShape::kStreak, streak) / lightOf(SpotShape::kBell, bell), 1.0, 1e-6);
}

}  // namespace
}  // namespace kerfbench::vision

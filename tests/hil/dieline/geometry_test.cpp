// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/geometry.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// Curves of every kind, some with nasty shapes: a full circle, a rational curve, a loop, a cusp, a doubled
/// end point.
std::vector<Curve> samples() {
  std::vector<Curve> curves{
      LineCurve{{1, 2}, {-7, 5}},
      ArcCurve{{3, -1}, 12.5, 0.4, 2.2},
      ArcCurve{{3, -1}, 0.7, 3.0, -5.9},
      ArcCurve{{0, 0}, 2.5, 1.0, 2 * pi},
      EllipseCurve{{4, 5}, {10, 2}, {-0.5, 1.5}, 0.3, 4.5},
      EllipseCurve{{4, 5}, {30, 0}, {0, 0.5}, -1.0, -3.0},
      EllipseCurve{{0, 0}, {8, 0}, {0, 3}, 0.0, 2 * pi},
  };
  BezierCurve b;
  b.control_mm << 0, 3, 9, 10, 0, 8, -6, 2;
  curves.emplace_back(b);
  b.weight << 1, 0.3, 2.5, 0.8;
  curves.emplace_back(b);
  b.weight.setOnes();
  b.control_mm << 0, 12, -2, 10, 0, 9, 9, 0;  // A loop.
  curves.emplace_back(b);
  b.control_mm << 0, 10, 0, 10, 0, 10, 10, 0;  // A cusp at the middle.
  curves.emplace_back(b);
  b.control_mm << 0, 0, 5, 9, 0, 0, 7, 1;  // The derivative vanishes at the start.
  curves.emplace_back(b);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-50, 50);
  std::uniform_real_distribution<double> weight(0.2, 4);
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 4; ++k) {
      b.control_mm.col(k) << coordinate(random), coordinate(random);
      b.weight(k) = weight(random);
    }
    curves.emplace_back(b);
  }
  return curves;
}

TEST(Geometry, DerivativeAgreesWithDifferences) {
  for (const Curve& curve : samples()) {
    for (const double u : {0.1, 0.37, 0.9}) {
      const double h = 1e-6;
      const Vector2d difference = (pointAt(curve, u + h) - pointAt(curve, u - h)) / (2 * h);
      EXPECT_LT((derivativeAt(curve, u) - difference).norm(), 1e-6 * (1 + difference.norm()))
          << curve.index();
    }
  }
}

TEST(Geometry, CurvatureIsTheTurnOfTheTangentPerLength) {
  for (const Curve& curve : samples()) {
    for (const double u : {0.1, 0.37, 0.9}) {
      const double h = 1e-5;
      const Vector2d before = tangentAt(curve, u - h);
      const Vector2d after = tangentAt(curve, u + h);
      const double turn = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
      const double per_length = turn / (derivativeAt(curve, u).norm() * 2 * h);
      EXPECT_NEAR(curvatureAt(curve, u), per_length, 1e-5 * (1 + std::abs(per_length))) << curve.index();
    }
  }
}

TEST(Geometry, CurvatureOfACircleIsItsSignedInverseRadius) {
  EXPECT_NEAR(curvatureAt(ArcCurve{{1, 1}, 4, 0, 1}, 0.5), 0.25, 1e-15);
  EXPECT_NEAR(curvatureAt(ArcCurve{{1, 1}, 4, 0, -1}, 0.5), -0.25, 1e-15);
}

TEST(Geometry, TangentExistsWhereTheDerivativeVanishes) {
  BezierCurve b;
  b.control_mm << 0, 0, 3, 9, 0, 0, 4, 1;
  EXPECT_EQ(derivativeAt(b, 0).norm(), 0);
  EXPECT_LT((tangentAt(b, 0) - Vector2d(0.6, 0.8)).norm(), 1e-4);
  EXPECT_EQ(tangentAt(LineCurve{{1, 1}, {1, 1}}, 0.5), Vector2d(1, 0));
}

TEST(Geometry, LengthAgreesWithAFinePolygon) {
  for (const Curve& curve : samples()) {
    // The length by Richardson on chords: the error of n chords falls with 1/n².
    const auto chords = [&](int n) {
      double sum = 0;
      for (int i = 0; i < n; ++i)
        sum += (pointAt(curve, (i + 1.0) / n) - pointAt(curve, double(i) / n)).norm();
      return sum;
    };
    const double expected = (4 * chords(40000) - chords(20000)) / 3;
    EXPECT_NEAR(lengthOf(curve), expected, 2e-9 * expected) << curve.index();
  }
}

TEST(Geometry, LengthOfARationalQuarterCircleIsExact) {
  const double w = std::sqrt(0.5);
  BezierCurve b;  // The quadratic (1, w, 1) raised by one degree.
  b.weight << 1, (1 + 2 * w) / 3, (1 + 2 * w) / 3, 1;
  b.control_mm << 1, 1, (2 * w) / (1 + 2 * w), 0, 0, (2 * w) / (1 + 2 * w), 1, 1;
  b.control_mm.col(1) = Vector2d(1 + 2 * w, 2 * w) / (1 + 2 * w);
  b.control_mm.col(2) = Vector2d(2 * w, 1 + 2 * w) / (1 + 2 * w);
  b.control_mm.col(3) = Vector2d(0, 1);
  EXPECT_NEAR(lengthOf(b), pi / 2, 1e-12);
  for (int i = 0; i <= 10; ++i) EXPECT_NEAR(pointAt(b, i / 10.0).norm(), 1, 1e-15);
}

TEST(Geometry, ReversedRunsTheOtherWayAndBack) {
  for (const Curve& curve : samples()) {
    const Curve back = reversed(curve);
    for (const double u : {0.0, 0.2, 0.5, 1.0}) {
      EXPECT_LT((pointAt(back, u) - pointAt(curve, 1 - u)).norm(), 1e-12);
      EXPECT_LT((derivativeAt(back, u) + derivativeAt(curve, 1 - u)).norm(), 1e-9);
    }
    EXPECT_LT(apart(reversed(back), curve), 1e-12);
  }
}

TEST(Geometry, TransformedIsThePointwiseImage) {
  Eigen::Affine2d shear = Eigen::Affine2d::Identity();
  shear.matrix().topRows<2>() << 1.2, 0.7, 3, -0.1, 0.8, -4;
  Eigen::Affine2d mirror = Eigen::Affine2d::Identity();
  mirror.rotate(0.3).scale(Vector2d(-2, 2)).translate(Vector2d(5, 1));
  for (const Curve& curve : samples()) {
    for (const Eigen::Affine2d& X : {shear, mirror}) {
      const Curve image = transformed(curve, X);
      for (int i = 0; i <= 20; ++i)
        EXPECT_LT((pointAt(image, i / 20.0) - X * pointAt(curve, i / 20.0)).norm(), 1e-11);
    }
  }
}

TEST(Geometry, ArcsStayArcsUnderSimilaritiesOnly) {
  const ArcCurve arc{{1, 2}, 3, 0.5, 1.5};
  Eigen::Affine2d similar = Eigen::Affine2d::Identity();
  similar.rotate(1.1).scale(2.0);
  const auto turned = transformed(arc, similar);
  ASSERT_TRUE(std::holds_alternative<ArcCurve>(turned));
  EXPECT_NEAR(std::get<ArcCurve>(turned).radius_mm, 6, 1e-12);
  EXPECT_EQ(std::get<ArcCurve>(turned).sweep_rad, 1.5);
  const auto mirrored = transformed(arc, similar * Eigen::Scaling(1.0, -1.0));
  ASSERT_TRUE(std::holds_alternative<ArcCurve>(mirrored));
  EXPECT_EQ(std::get<ArcCurve>(mirrored).sweep_rad, -1.5);
  EXPECT_TRUE(std::holds_alternative<EllipseCurve>(transformed(arc, similar * Eigen::Scaling(1.0, 1.001))));
}

TEST(Geometry, ClosedMeansBothEndsAgree) {
  EXPECT_TRUE(isClosed(ArcCurve{{1, 1}, 100, 0.3, 2 * pi}));
  EXPECT_TRUE(isClosed(EllipseCurve{{1, 1}, {5, 0}, {0, 2}, 0.3, -2 * pi}));
  EXPECT_FALSE(isClosed(ArcCurve{{1, 1}, 100, 0.3, 2 * pi - 1e-6}));
  EXPECT_FALSE(isClosed(LineCurve{{0, 0}, {1, 0}}));
}

TEST(Geometry, NearestAgreesWithBruteForce) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> coordinate(-60, 60);
  for (const Curve& curve : samples()) {
    for (int k = 0; k < 40; ++k) {
      const Vector2d p(coordinate(random), coordinate(random));
      double brute = 1e99;
      for (int i = 0; i <= 4000; ++i) brute = std::min(brute, (pointAt(curve, i / 4000.0) - p).norm());
      const Nearest nearest = nearestOn(curve, p);
      EXPECT_LE(nearest.distance_mm, brute + 1e-12) << curve.index();
      EXPECT_GE(nearest.distance_mm, brute - 0.1) << curve.index();
      EXPECT_NEAR((pointAt(curve, nearest.u) - p).norm(), nearest.distance_mm, 1e-9);
      EXPECT_GE(nearest.u, 0);
      EXPECT_LE(nearest.u, 1);
    }
  }
}

TEST(Geometry, NearestToAPointOnTheCurveIsThatPoint) {
  for (const Curve& curve : samples()) {
    for (const double u : {0.0, 0.123, 0.5, 0.77, 1.0})
      EXPECT_LT(nearestOn(curve, pointAt(curve, u)).distance_mm, 1e-7);
  }
}

TEST(Geometry, NearestToTheCentreOfAnArcIsItsRadiusAway) {
  EXPECT_NEAR(nearestOn(ArcCurve{{2, 3}, 4, 1, 1}, {2, 3}).distance_mm, 4, 1e-15);
}

TEST(Geometry, StationsAreEquallySpacedAlongTheCurve) {
  for (const Curve& curve : samples()) {
    const std::vector<double> u = stations(curve, 0.5);
    ASSERT_GE(u.size(), 2U);
    EXPECT_EQ(u.front(), 0);
    EXPECT_EQ(u.back(), 1);
    const double spacing = lengthOf(curve) / static_cast<double>(u.size() - 1);
    EXPECT_LE(spacing, 0.5 * (1 + 1e-9));
    EXPECT_GT(spacing, 0.2);
    for (std::size_t i = 0; i + 1 < u.size(); ++i) {
      double along = 0;  // Length of the piece by chords.
      for (int k = 0; k < 200; ++k) {
        const double du = (u[i + 1] - u[i]) / 200;
        along += (pointAt(curve, u[i] + (k + 1) * du) - pointAt(curve, u[i] + k * du)).norm();
      }
      EXPECT_NEAR(along, spacing, 2e-4 * spacing) << curve.index();
    }
  }
}

TEST(Geometry, StationsOfANearlyExactMultipleGetNoExtraPiece) {
  EXPECT_EQ(stations(LineCurve{{0, 0}, {0.3, 0}}, 0.1).size(), 4U);
  EXPECT_EQ(stations(LineCurve{{0, 0}, {0, 0}}, 0.1).size(), 2U);
  EXPECT_THROW(stations(LineCurve{{0, 0}, {1, 0}}, 0.0), std::invalid_argument);
  EXPECT_THROW(stations(LineCurve{{0, 0}, {1, 0}}, std::nan("")), std::invalid_argument);
}

TEST(Geometry, BoundsAreTheBoxOfManySamples) {
  for (const Curve& curve : samples()) {
    Dieline dieline;
    dieline.entities.push_back({0, curve, Process::kCut, "CUT", ""});
    dieline.entities.push_back({1, LineCurve{{500, 500}, {600, 600}}, Process::kIgnore, "notes", ""});
    const Eigen::AlignedBox2d box = dieline.bounds();
    Eigen::AlignedBox2d sampled;
    for (int i = 0; i <= 200000; ++i) sampled.extend(pointAt(curve, i / 200000.0));
    EXPECT_LT((box.min() - sampled.min()).norm(), 1e-6) << curve.index();
    EXPECT_LT((box.max() - sampled.max()).norm(), 1e-6) << curve.index();
    EXPECT_TRUE(((box.max() - sampled.max()).array() > -1e-9).all());
  }
  EXPECT_TRUE(Dieline{}.bounds().isEmpty());
}

}  // namespace
}  // namespace kerfbench::dieline

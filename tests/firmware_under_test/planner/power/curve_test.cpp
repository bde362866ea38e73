// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/curve.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace kerfbench::planner {
namespace {

Curve randomCurve(std::mt19937_64& random) {
  std::uniform_real_distribution<double> step(1e-3, 5.0);
  std::vector<Curve::Point> points{{step(random), step(random)}};
  const int count = std::uniform_int_distribution<int>(1, 12)(random);
  for (int i = 0; i < count; ++i)
    points.push_back({points.back().x + step(random), points.back().y + step(random)});
  return Curve(points);
}

TEST(Curve, ItsInverseLeadsBack) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 2000; ++i) {
    const Curve curve = randomCurve(random);
    std::uniform_real_distribution<double> inside(curve.least().x, curve.greatest().x);
    const double x = inside(random);
    EXPECT_NEAR(curve.inverse(curve.at(x)).value(), x, 1e-6);
  }
}

TEST(Curve, GoesThroughItsPointsExactlyAndRises) {
  std::mt19937_64 random(12);
  for (int i = 0; i < 200; ++i) {
    const Curve curve = randomCurve(random);
    for (const Curve::Point& point : curve.points()) {
      EXPECT_EQ(curve.at(point.x), point.y);
      EXPECT_EQ(curve.inverse(point.y), point.x);
    }
    double before = curve.least().y;
    for (int k = 1; k <= 300; ++k) {
      const double now =
          curve.at(curve.least().x + (curve.greatest().x - curve.least().x) * std::min(1.0, k / 300.0));
      EXPECT_GT(now, before);
      before = now;
    }
  }
}

TEST(Curve, LiesHalfWayBetweenNeighbours) {
  const Curve curve({{1, 10}, {3, 20}, {7, 80}});
  EXPECT_DOUBLE_EQ(curve.at(2), 15.0);
  EXPECT_DOUBLE_EQ(curve.at(5), 50.0);
  EXPECT_DOUBLE_EQ(curve.inverse(35).value(), 4.0);
}

TEST(Curve, BeyondItsEndsItSaturatesAndHasNoInverse) {
  const Curve curve({{1, 10}, {3, 20}});
  EXPECT_EQ(curve.at(0.0), 10.0);
  EXPECT_EQ(curve.at(1e308), 20.0);
  EXPECT_EQ(curve.at(std::numeric_limits<double>::infinity()), 20.0);
  EXPECT_FALSE(curve.inverse(9.999));
  EXPECT_FALSE(curve.inverse(20.001));
  EXPECT_FALSE(curve.inverse(std::numeric_limits<double>::quiet_NaN()));
}

TEST(Curve, RefusesWhatDoesNotRise) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<Curve::Point>& points :
       std::vector<std::vector<Curve::Point>>{{},
                                              {{1, 1}},
                                              {{1, 1}, {1, 2}},
                                              {{1, 1}, {2, 1}},
                                              {{1, 1}, {0, 2}},
                                              {{1, 1}, {2, 0}},
                                              {{1, nan}, {2, 2}},
                                              {{nan, 1}, {2, 2}},
                                              {{1, 1}, {2, 1.0 / 0.0}}}) {
    EXPECT_THROW(Curve{points}, PowerError);
  }
}

}  // namespace
}  // namespace kerfbench::planner

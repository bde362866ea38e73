// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/geometry/jump_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

Vector2d direction(double degrees) {
  return {std::cos(degrees * pi / 180.0), std::sin(degrees * pi / 180.0)};
}

JumpEnds ends(const Vector2d& from, double from_deg, const Vector2d& to, double to_deg) {
  return {from, direction(from_deg), to, direction(to_deg)};
}

/// Positions and directions go on without a step from the first mark to the second, and no arc is tighter.
void expectTangent(const std::vector<Segment>& path, const JumpEnds& ends, double radius_mm) {
  Vector2d at = ends.from_mm;
  Vector2d along = ends.from_direction;
  for (const Segment& segment : path) {
    EXPECT_TRUE(segment.jump);
    EXPECT_LT((segment.start_mm - at).norm(), 1e-9);
    EXPECT_LT((segment.tangentAt(0.0) - along).norm(), 1e-6);
    if (segment.isArc()) {
      EXPECT_NEAR(segment.radiusMm(), radius_mm, 1e-8);
      EXPECT_NEAR((segment.start_mm - segment.centre_mm).norm(), (segment.end_mm - segment.centre_mm).norm(),
                  1e-8);
    }
    at = segment.at(segment.lengthMm());
    along = segment.tangentAt(segment.lengthMm());
    EXPECT_LT((at - segment.end_mm).norm(), 1e-8);
  }
  EXPECT_LT((at - ends.to_mm).norm(), 1e-8);
  EXPECT_LT((along - ends.to_direction).norm(), 1e-6);
}

JumpEnds random(std::mt19937& bits, double reach_mm) {
  std::uniform_real_distribution<double> place(-reach_mm, reach_mm);
  std::uniform_real_distribution<double> angle(0.0, 360.0);
  const Vector2d from(place(bits), place(bits));
  const Vector2d to(place(bits), place(bits));
  return ends(from, angle(bits), to, angle(bits));
}

TEST(JumpOver, IsTangentToBothMarksOnEachSide) {
  std::mt19937 bits(1);
  int without = 0;
  for (int i = 0; i < 2000; ++i) {
    const JumpEnds some = random(bits, i % 2 == 0 ? 3.0 : 30.0);
    for (const JumpSides sides : {JumpSides{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
      const auto path = jumpOver(some, 1.0, sides);
      if (!path) {
        EXPECT_NE(sides.first, sides.second) << "equal circles always have outer tangents";
        ++without;
        continue;
      }
      ASSERT_LE(path->size(), 3U);
      expectTangent(*path, some, 1.0);
    }
  }
  EXPECT_GT(without, 100);
}

/// The four common tangents of S2's figure 3, found another way: lines at distance R from both centres, as
/// roots of an angle. Exactly one agrees with the senses at both circles, and it is the one that jumpOver()
/// takes.
TEST(JumpOver, TakesTheOnlyTangentWhoseSenseAgreesAtBothCircles) {
  std::mt19937 bits(2);
  for (int i = 0; i < 500; ++i) {
    const JumpEnds some = random(bits, 30.0);
    for (const JumpSides sides : {JumpSides{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
      const Vector2d left1(-some.from_direction.y(), some.from_direction.x());
      const Vector2d left2(-some.to_direction.y(), some.to_direction.x());
      const Vector2d o1 = some.from_mm + 2.0 * sides.first * left1;
      const Vector2d o2 = some.to_mm + 2.0 * sides.second * left2;
      if ((o2 - o1).norm() < 4.1) continue;
      int agree = 0;
      for (const int first : {1, -1}) {
        for (const int second : {1, -1}) {
          // n·(o2 - o1) = R (second - first) with n the unit normal of the line: two lines for each pair of
          // signs, of which one runs from o1 to o2.
          const double apart = (o2 - o1).norm();
          const double base = std::atan2(o2.y() - o1.y(), o2.x() - o1.x());
          const double turn = std::acos(2.0 * (second - first) / apart);
          for (const double angle : {base + turn, base - turn}) {
            const Vector2d normal(std::cos(angle), std::sin(angle));
            const Vector2d c = o1 - 2.0 * first * normal;
            const Vector2d d = o2 - 2.0 * second * normal;
            const Vector2d along = (d - c).normalized();
            const double w1 = cross(some.from_direction, o1 - some.from_mm);
            const double w2 = cross(along, o2 - d);
            if (w1 * cross(along, o1 - c) > 0.0 && w2 * cross(some.to_direction, o2 - some.to_mm) > 0.0) {
              // Each line with given first and second turns up once as it is and once by the mirrored normal.
              if (first == 1) ++agree;
              const auto path = jumpOver(some, 2.0, sides);
              ASSERT_TRUE(path);
              const auto line =
                  std::find_if(path->begin(), path->end(), [](const Segment& s) { return !s.isArc(); });
              ASSERT_NE(line, path->end());
              EXPECT_LT((line->start_mm - c).norm(), 1e-6);
              EXPECT_LT((line->end_mm - d).norm(), 1e-6);
            }
          }
        }
      }
      EXPECT_EQ(agree, 1);
    }
  }
}

TEST(SmoothJump, TakesTheNearestCentres) {
  // Two strokes of a comb, up and down, 6 mm apart: both circles inside, a U.
  const auto path = smoothJump(ends({0, 0}, 90, {6, 0}, -90), 2.0);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->size(), 3U);
  EXPECT_NEAR(lengthOf(*path), 2.0 * pi + 2.0, 1e-9);
  EXPECT_NEAR((*path)[0].sweep_rad, -pi / 2, 1e-9);
}

TEST(SmoothJump, IsNeverLongerThanTheStraightWayAndATurn) {
  std::mt19937 bits(3);
  int none = 0;
  for (int i = 0; i < 5000; ++i) {
    const JumpEnds some = random(bits, 4.0);
    const auto path = smoothJump(some, 1.0);
    if (!path) {
      ++none;
      continue;
    }
    EXPECT_LE(lengthOf(*path), (some.to_mm - some.from_mm).norm() + 2.0 * pi + 1e-9);
    expectTangent(*path, some, 1.0);
  }
  EXPECT_GT(none, 0) << "near ends that point badly have no short way";
  EXPECT_LT(none, 1000);
}

TEST(SmoothJump, ASmallerRadiusAlwaysServesEndsThatLieApart) {
  std::mt19937 bits(4);
  for (int i = 0; i < 2000; ++i) {
    const JumpEnds some = random(bits, 4.0);
    const double apart_mm = (some.to_mm - some.from_mm).norm();
    EXPECT_TRUE(smoothJump(some, 0.24 * apart_mm)) << i;
  }
}

TEST(SmoothJump, MarksOnOneLineAreJoinedByTheLine) {
  const auto path = smoothJump(ends({0, 0}, 30, 4.0 * direction(30), 30), 5.0);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->size(), 1U);
  EXPECT_FALSE((*path)[0].isArc());
  EXPECT_NEAR(lengthOf(*path), 4.0, 1e-12);
}

TEST(SmoothJump, CoincidentEnds) {
  // Equal ends with the same direction need no jump.
  const auto same = smoothJump(ends({1, 2}, 40, {1, 2}, 40), 2.0);
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->empty());
  // Other directions need more than a turn: 5/4 of one and a line for a right angle.
  EXPECT_FALSE(smoothJump(ends({1, 2}, 0, {1, 2}, 90), 2.0));
  EXPECT_FALSE(smoothJump(ends({1, 2}, 0, {1, 2}, 180), 2.0));
  const auto loop = jumpOver(ends({1, 2}, 0, {1, 2}, 90), 2.0, {1, 1});
  ASSERT_TRUE(loop);
  expectTangent(*loop, ends({1, 2}, 0, {1, 2}, 90), 2.0);
  EXPECT_NEAR(lengthOf(*loop), 2.0 * (2.5 * pi + std::sqrt(2.0)), 1e-9);
}

TEST(SmoothJump, ParallelAndAntiparallelMarks) {
  for (const double apart : {0.1, 1.0, 1.999999, 2.0, 2.000001, 3.9999999, 4.0, 4.0000001, 9.0}) {
    for (const double shift : {-6.0, -1.0, 0.0, 1.0, 6.0}) {
      for (const double to_deg : {0.0, 180.0}) {
        const JumpEnds some = ends({0, 0}, 0, {shift, apart}, to_deg);
        for (const JumpSides sides : {JumpSides{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
          if (const auto path = jumpOver(some, 1.0, sides)) expectTangent(*path, some, 1.0);
        }
        if (const auto path = smoothJump(some, 1.0)) expectTangent(*path, some, 1.0);
      }
    }
  }
  // Antiparallel marks 2 R apart share one circle, half of which is the jump.
  const auto half = smoothJump(ends({0, 0}, 0, {0, 2}, 180), 1.0);
  ASSERT_TRUE(half);
  ASSERT_EQ(half->size(), 1U);
  EXPECT_NEAR((*half)[0].sweep_rad, pi, 1e-9);
}

TEST(SmoothJump, TouchingCirclesLeaveNoLine) {
  // The jump is an S of two quarter turns.
  const auto path = smoothJump(ends({0, 0}, 0, {2, 2}, 0), 1.0);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->size(), 2U);
  EXPECT_NEAR((*path)[0].sweep_rad, pi / 2, 1e-6);
  EXPECT_NEAR((*path)[1].sweep_rad, -pi / 2, 1e-6);
}

TEST(SmoothJump, WhereTheNearestCirclesOverlapTheNextServe) {
  std::mt19937 bits(5);
  int served = 0;
  for (int i = 0; i < 2000; ++i) {
    const JumpEnds some = random(bits, 2.0);
    JumpSides nearest;
    double least_mm = 1e9;
    for (const JumpSides sides : {JumpSides{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
      const Vector2d first(-some.from_direction.y(), some.from_direction.x());
      const Vector2d second(-some.to_direction.y(), some.to_direction.x());
      const double apart_mm =
          (some.to_mm + sides.second * second - some.from_mm - sides.first * first).norm();
      if (apart_mm < least_mm) least_mm = apart_mm, nearest = sides;
    }
    const auto path = smoothJump(some, 1.0);
    if (jumpOver(some, 1.0, nearest) || !path) continue;
    EXPECT_NE(nearest.first, nearest.second);
    expectTangent(*path, some, 1.0);
    ++served;
  }
  EXPECT_GT(served, 20);
}

TEST(PaperRadius, IsThePapersAtItsTwoFields) {
  EXPECT_DOUBLE_EQ(paperRadiusMm(10.0), 1.0);
  EXPECT_DOUBLE_EQ(paperRadiusMm(100.0), 5.0);
  EXPECT_DOUBLE_EQ(paperRadiusMm(3.0), 1.0);
  EXPECT_DOUBLE_EQ(paperRadiusMm(300.0), 5.0);
  EXPECT_GT(paperRadiusMm(50.0), 3.0);
}

TEST(JumpOver, ARadiusOfNothingThrows) {
  EXPECT_THROW(static_cast<void>(jumpOver({}, 0.0, {1, 1})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(jumpOver({}, NAN, {1, 1})), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::planner

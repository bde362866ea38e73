// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/compensation/space_check.h"
#include "firmware_under_test/planner/compensation/space_path.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector3d;

constexpr double kDeg = std::numbers::pi / 180.0;

FoldCorner degrees(double alpha, double beta, double omega) {
  return {alpha * kDeg, beta * kDeg, omega * kDeg};
}

std::string refusal(const SpaceContour& contour, double radius = 0.1) {
  try {
    offsetInSpace(contour, radius);
  } catch (const CompensationError& error) {
    return error.what();
  }
  return {};
}

/// Tests the four joints and their eight cases, on both sides of the right angle of each.
TEST(SpaceOffset, NeverNearerThanTheRadiusAndStrictWhereverPossible) {
  const double r = 0.1;
  std::vector<int> seen(9, 0);
  for (double alpha = 10.0; alpha < 180.0; alpha += 20.0) {
    for (double beta = 12.0; beta < 180.0; beta += 21.0) {
      for (const double omega : {90.0, 120.0, 179.9, 180.1, 210.0, 270.0, 300.0, 345.0}) {
        for (const Side side : {Side::kLeft, Side::kRight}) {
          SCOPED_TRACE(testing::Message() << alpha << " " << beta << " " << omega);
          const SpaceCorner corner = SpaceCorner::of(degrees(alpha, beta, omega), 200.0 * r, side);
          const SpacePath path = offsetInSpace(corner.contour(), r);
          const SpaceCheck check = checkCorner(corner, path.points, r);
          EXPECT_GT(check.nearest_mm, r * (1.0 - 1e-9));
          EXPECT_LT(check.missed_mm, r * 1e-6);
          EXPECT_LT(check.off_surface_mm, 1e-9);
          ASSERT_EQ(path.joints.size(), 1U);
          EXPECT_NEAR(path.joints[0].corner.alpha_rad / kDeg, alpha, 1e-9);
          EXPECT_NEAR(path.joints[0].corner.beta_rad / kDeg, beta, 1e-9);
          EXPECT_NEAR(path.joints[0].corner.omega_rad / kDeg, omega, 1e-9);
          EXPECT_LE(path.points.size(), omega <= 270.0 ? 8U : 14U);
          ++seen[static_cast<std::size_t>(path.joints[0].number)];
        }
      }
    }
  }
  for (int number = 1; number <= 8; ++number) EXPECT_GT(seen[static_cast<std::size_t>(number)], 0) << number;
}

TEST(SpaceOffset, EqualAnglesNeedOnePoint) {
  for (const double angle : {20.0, 60.0, 90.0, 130.0}) {
    const SpaceCorner corner = SpaceCorner::of(degrees(angle, angle, 250.0), 20.0, Side::kLeft);
    const SpacePath path = offsetInSpace(corner.contour(), 0.1);
    EXPECT_EQ(path.joints[0].joint, SpaceJoint::kOnePoint);
    ASSERT_EQ(path.points.size(), 4U);
    EXPECT_EQ(path.points[1].p_mm, path.points[2].p_mm);
    EXPECT_NEAR((path.points[1].p_mm - corner.b).norm(), 0.1 / std::sin(angle * kDeg), 1e-12);
    EXPECT_GT(checkCorner(corner, path.points, 0.1).nearest_mm, 0.1 * (1.0 - 1e-9));
  }
}

TEST(SpaceOffset, WithinAHundredthOfADegreeOf180TheCornerIsPlane) {
  for (const double omega : {179.991, 180.0, 180.009}) {
    const SpaceCorner corner = SpaceCorner::of(degrees(80.0, 60.0, omega), 5.0, Side::kLeft);
    EXPECT_EQ(offsetInSpace(corner.contour(), 0.1).joints[0].joint, SpaceJoint::kPlanar);
  }
  for (const double omega : {179.98, 180.02}) {
    const SpaceCorner corner = SpaceCorner::of(degrees(80.0, 60.0, omega), 5.0, Side::kLeft);
    EXPECT_EQ(offsetInSpace(corner.contour(), 0.1).joints[0].joint, SpaceJoint::kRadius);
  }
}

TEST(SpaceOffset, PlaneCornersShortenExtendAndGoRound) {
  for (double turn = -170.0; turn <= 170.0; turn += 10.0) {
    SpaceContour contour;
    const Vector3d n = Vector3d(0.3, -0.5, 0.8).normalized();
    const Vector3d x = n.unitOrthogonal();
    const Vector3d y = n.cross(x);
    contour.points = {{-9.0 * x, n},
                      {Vector3d::Zero(), n},
                      {9.0 * (std::cos(turn * kDeg) * x + std::sin(turn * kDeg) * y), n}};
    for (const Side side : {Side::kLeft, Side::kRight}) {
      contour.side = side;
      const SpacePath path = offsetInSpace(contour, 0.2);
      double nearest = INFINITY;
      for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
        for (std::size_t j = 0; j < 2; ++j) {
          nearest = std::min(nearest, distanceMm(path.points[i].p_mm, path.points[i + 1].p_mm,
                                                 contour.points[j].p_mm, contour.points[j + 1].p_mm));
        }
      }
      EXPECT_NEAR(nearest, 0.2, 1e-9);
      const bool away = (side == Side::kLeft) == (turn < 0.0);
      EXPECT_EQ(path.points.size(), away && std::abs(turn) > 90.0 ? 4U : 3U);
    }
  }
}

TEST(SpaceOffset, AClosedContourRoundABoxEndsWhereItBegins) {
  // The contour leads round a square column: over four edges of 270 degrees, each crossed at a right angle.
  SpaceContour contour;
  contour.points = {{{1, -2, 0}, {0, -1, 0}}, {{2, -2, 0}, {1, 0, 0}},   {{2, 2, 0.5}, {0, 1, 0}},
                    {{-2, 2, 0}, {-1, 0, 0}}, {{-2, -2, 0}, {0, -1, 0}}, {{1, -2, 0}, {0, -1, 0}}};
  for (const Side side : {Side::kLeft, Side::kRight}) {
    contour.side = side;
    const SpacePath path = offsetInSpace(contour, 0.1);
    EXPECT_LT((path.points.front().p_mm - path.points.back().p_mm).norm(), 1e-12);
    EXPECT_EQ(path.joints.size(), 5U);
  }
}

/// Tests a strip folded at random, run along from either end with the beam on the same side of it.
TEST(SpaceOffset, RunBackwardsThePathIsTheSame) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  int paths = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SpaceContour contour;
    Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  // Columns: fold, across it in the plane, normal.
    Vector3d p(1.0, 2.0, 3.0);
    for (int i = 0; i < 6; ++i) {
      contour.points.push_back({p, frame.col(2)});
      const double slant = uniform(-1.1, 1.1);
      p += uniform(2.0, 5.0) * (std::sin(slant) * frame.col(0) + std::cos(slant) * frame.col(1));
      const double fold = uniform(-80.0, 120.0) * kDeg;  // > 0: the edge sticks out
      frame = Eigen::AngleAxisd(-fold, frame.col(0)) * frame;
    }
    contour.points.push_back({p, frame.col(2)});
    SpaceContour back;
    for (std::size_t i = contour.points.size(); i-- > 0;) {
      back.points.push_back({contour.points[i].p_mm, contour.points[i > 0 ? i - 1 : 0].axis});
    }
    back.side = Side::kRight;
    const std::string why = refusal(contour, 0.15);
    EXPECT_EQ(why.empty(), refusal(back, 0.15).empty()) << why << "\n" << refusal(back, 0.15);
    if (!why.empty()) continue;
    ++paths;
    const SpacePath there = offsetInSpace(contour, 0.15);
    const SpacePath again = offsetInSpace(back, 0.15);
    ASSERT_EQ(there.points.size(), again.points.size());
    for (std::size_t i = 0; i < there.points.size(); ++i) {
      const SpacePoint& other = again.points[there.points.size() - 1 - i];
      EXPECT_LT((there.points[i].p_mm - other.p_mm).norm(), 1e-9);
      EXPECT_LT((there.points[i].axis - other.axis).norm(), 1e-9);
    }
  }
  EXPECT_GT(paths, 30);
}

TEST(SpaceHostile, AnglesBeyondTheLimits) {
  for (const double omega : {20.0, 60.0, 89.9}) {
    const SpaceCorner corner = SpaceCorner::of(degrees(70.0, 60.0, omega), 5.0, Side::kLeft);
    EXPECT_NE(refusal(corner.contour()).find("the head has no room"), std::string::npos) << omega;
  }
  for (const double omega : {350.1, 355.0, 359.9}) {
    const SpaceCorner corner = SpaceCorner::of(degrees(70.0, 60.0, omega), 5.0, Side::kLeft);
    EXPECT_NE(refusal(corner.contour()).find("pierces the second plane"), std::string::npos) << omega;
  }
  EXPECT_EQ(refusal(SpaceCorner::of(degrees(70.0, 60.0, 90.0), 5.0, Side::kLeft).contour()), "");
  for (const double omega : {0.0, 360.0}) {
    EXPECT_NE(refusal(SpaceCorner::of(degrees(70.0, 60.0, omega), 5.0, Side::kLeft).contour()), "");
  }
}

TEST(SpaceHostile, EveryFaultIsNamedByItsLine) {
  SpaceContour contour;
  contour.points = {{{0, 0, 0}, {0, 0, 1}},   {{5, 0, 0}, {0, 0, 1}},  {{5, 0, 0}, {0, 0, 1}},
                    {{9, 0, 0}, {0, 0, 2}},   {{12, 0, 0}, {1, 0, 0}}, {{15, 0, 0}, {0, 0, 1}},
                    {{NAN, 0, 0}, {0, 0, 1}}, {{20, 0, 0}, {0, 0, 1}}};
  contour.file_lines = {3, 4, 5, 7, 8, 9, 10, 11};
  const std::string faults = refusal(contour);
  for (const char* part : {"line 4: (5.000, 0.000, 0.000): a line of no length", "line 7: ", "no unit vector",
                           "line 8: ", "stands 90.00", "line 9: ", "line 10: ", "not finite"}) {
    EXPECT_NE(faults.find(part), std::string::npos) << part << " in\n" << faults;
  }
}

TEST(SpaceHostile, WhatHasNoPathIsRefused) {
  const Vector3d up = Vector3d::UnitZ();
  SpaceContour contour;
  contour.points = {{{0, 0, 0}, up}, {{5, 0, 0}, up}, {{0, 0, 0}, up}};
  EXPECT_NE(refusal(contour).find("turns back on itself"), std::string::npos);
  // The second line runs along the fold between its planes.
  contour.points = {{{0, 0, 0}, up}, {{5, 0, 0}, {0, 1, 0}}, {{5, 0, -5}, up}};
  EXPECT_NE(refusal(contour).find("runs along the fold"), std::string::npos);
  // The axis flips to the back of the sheet.
  contour.points = {{{0, 0, 0}, up}, {{5, 0, 0}, {-0.6, 0, -0.8}}, {{9, 0, -3}, up}};
  EXPECT_NE(refusal(contour).find("other face"), std::string::npos);
  // A step shorter than its two joints take.
  contour.points = {{{0, 0, 0}, up}, {{5, 0, 0}, up}, {{5, 0.1, 0}, up}, {{0, 0.1, 0}, up}};
  EXPECT_NE(refusal(contour).find("its joints take 0.2"), std::string::npos);
  // A slot narrower than the kerf between lines that are no neighbours.
  contour.points = {{{0, 0, 0}, up}, {{5, 0, 0}, up},   {{5, 3, 0}, up},
                    {{3, 3, 0}, up}, {{3, 0.3, 0}, up}, {{0, 0.3, 0}, up}};
  EXPECT_NE(refusal(contour, 0.2).find("the path comes as near as"), std::string::npos);
  EXPECT_NE(refusal({}), "");
  for (const double radius : {0.0, -1.0, double(NAN), double(INFINITY)})
    EXPECT_NE(refusal(contour, radius), "");
}

}  // namespace
}  // namespace kerfbench::planner

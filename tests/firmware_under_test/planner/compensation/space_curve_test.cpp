// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_curve.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/compensation/space_check.h"
#include "firmware_under_test/planner/compensation/space_file.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Face tilted about two axes, with its own x and y.
struct TiltedFace {
  Vector3d o{7.0, -3.0, 20.0};
  Vector3d n{Vector3d(0.4, -0.6, 0.7).normalized()};
  Vector3d x{n.unitOrthogonal()};
  Vector3d y{n.cross(x)};
  [[nodiscard]] Vector3d at(double u, double v) const { return o + u * x + v * y; }
  [[nodiscard]] std::string row(double u, double v) const {
    const Vector3d p = at(u, v);
    return fmt::format("{:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f}\n", p.x(), p.y(), p.z(), n.x(), n.y(),
                       n.z());
  }
  [[nodiscard]] std::string place(double u, double v) const {
    const Vector3d p = at(u, v);
    return fmt::format(" {:.12f} {:.12f} {:.12f} ", p.x(), p.y(), p.z());
  }
};

/// Distance from the polyline of a curve's samples.
double nearest(const Vector3d& p, const std::function<Vector3d(double)>& curve, int samples) {
  double least = INFINITY;
  Vector3d from = curve(0.0);
  for (int i = 1; i <= samples; ++i) {
    const Vector3d to = curve(static_cast<double>(i) / samples);
    const double t = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - from - t * (to - from)).norm());
    from = to;
  }
  return least;
}

/// Least and largest distance of a path's samples from a curve, both sampled.
std::pair<double, double> distances(const SpacePath& path, const std::function<Vector3d(double)>& curve) {
  std::pair<double, double> range{INFINITY, 0.0};
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      const double t = 0.25 * quarter;
      const Vector3d p = (1.0 - t) * path.points[i].p_mm + t * path.points[i + 1].p_mm;
      const double d = nearest(p, curve, 1000);
      range = {std::min(range.first, d), std::max(range.second, d)};
    }
  }
  return range;
}

std::string faultOf(const std::string& text, double radius_mm = 0.1) {
  try {
    offsetInSpace(readSpaceContour(text, "f.xyz"), radius_mm);
  } catch (const CompensationError& error) {
    return error.what();
  }
  return {};
}

/// The offset of a circle is a circle: the path must lie between those of the chords' middles and corners.
TEST(SpaceCurve, ACircleInATiltedPlaneIsOffsetToACircle) {
  const TiltedFace face;
  const double big = 10.0;
  const double r = 0.2;
  const double e = 0.005;
  const std::string text =
      face.row(big, 0.0) + "centre" + face.place(0.0, 0.0) + "360\n" + face.row(big, 0.0);
  SpaceContour contour = readSpaceContour(text, "circle.xyz", e);
  ASSERT_EQ(contour.curves.size(), 1U);
  EXPECT_LE(contour.curves[0].error_mm, e);
  EXPECT_GT(contour.curves[0].error_mm, 0.9 * e);  // No more chords than it takes.
  for (const Side side : {Side::kLeft, Side::kRight}) {
    contour.side = side;
    const double out = side == Side::kLeft ? -1.0 : 1.0;  // Counter-clockwise: the centre is on the left.
    const SpacePath path = offsetInSpace(contour, r);
    ASSERT_EQ(path.points.size(), contour.points.size());
    EXPECT_LT((path.points.front().p_mm - path.points.back().p_mm).norm(), 1e-12);
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
      const Vector3d corner = path.points[i].p_mm - face.o;
      const Vector3d middle = 0.5 * (path.points[i].p_mm + path.points[i + 1].p_mm) - face.o;
      EXPECT_NEAR(corner.dot(face.n), 0.0, 1e-9);
      EXPECT_NEAR(corner.norm(), (big + out * r), 1.01 * e * r / big + 1e-9);
      EXPECT_GT(middle.norm(), big + out * r - e - 1e-9);
      EXPECT_LT(middle.norm(), big + out * r);
      EXPECT_LT((path.points[i].axis - face.n).norm(), 1e-9);
    }
  }
}

TEST(SpaceCurve, ThreePointsAndCentreGiveTheSameArcInBothSenses) {
  const TiltedFace face;
  for (const double degrees : {20.0, 100.0, 180.0, 250.0, 340.0, -20.0, -180.0, -300.0}) {
    SCOPED_TRACE(degrees);
    const double sweep = degrees / 360.0 * kTurn;
    const auto on = [&](double share) {
      return std::pair{5.0 * std::cos(0.3 + share * sweep), 5.0 * std::sin(0.3 + share * sweep)};
    };
    const auto [u0, v0] = on(0.0);
    const auto [um, vm] = on(0.4);
    const auto [u1, v1] = on(1.0);
    const SpaceContour by_via =
        readSpaceContour(face.row(u0, v0) + "via" + face.place(um, vm) + "\n" + face.row(u1, v1), "via.xyz");
    const SpaceContour by_centre = readSpaceContour(
        face.row(u0, v0) + "centre" + face.place(0.0, 0.0) + fmt::format("{}\n", degrees) + face.row(u1, v1),
        "centre.xyz");
    ASSERT_EQ(by_via.points.size(), by_centre.points.size());
    for (std::size_t i = 0; i < by_via.points.size(); ++i) {
      EXPECT_LT((by_via.points[i].p_mm - by_centre.points[i].p_mm).norm(), 1e-8);
      EXPECT_LT((by_via.points[i].axis - by_centre.points[i].axis).norm(), 1e-8);
      EXPECT_NEAR((by_via.points[i].p_mm - face.o).norm(), 5.0, 1e-9);
    }
  }
}

TEST(SpaceCurve, ABezierCurveInATiltedPlaneIsOffsetWithinTheChordError) {
  const TiltedFace face;
  const std::string text =
      face.row(0, 0) + "bezier" + face.place(10, 12) + face.place(20, -12) + "\n" + face.row(30, 0);
  const SpaceCubic cubic{{face.at(0, 0), face.at(10, 12), face.at(20, -12), face.at(30, 0)}, face.n, face.n};
  const auto curve = [&](double t) { return cubic.at(t); };
  std::size_t points = 0;
  for (const double e : {0.02, 0.005, 0.001}) {
    SpaceContour contour = readSpaceContour(text, "b.xyz", e);
    EXPECT_GT(contour.points.size(), points);
    points = contour.points.size();
    for (std::size_t i = 0; i + 1 < points; ++i) {  // The chords themselves, at their middles.
      const Vector3d middle = 0.5 * (contour.points[i].p_mm + contour.points[i + 1].p_mm);
      EXPECT_LT(nearest(middle, curve, 1000), e + 1e-5);
    }
    for (const Side side : {Side::kLeft, Side::kRight}) {
      contour.side = side;
      const auto [least, most] = distances(offsetInSpace(contour, 0.3), curve);
      EXPECT_GT(least, 0.3 - e);
      EXPECT_LT(most, 0.3 + e);
    }
  }
}

/// A helix on a tube: the surface turns under the spline, and folds lie between all chords.
TEST(SpaceCurve, ASplineOnATubeKeepsToTheSurfaceAndTheRadius) {
  const auto helix = [](double t) {
    const double a = 0.5 * kTurn * t;
    return Vector3d(30.0 * t, 20.0 * std::sin(a), 20.0 * std::cos(a));
  };
  std::string text;
  for (int k = 0; k <= 24; ++k) {
    const Vector3d p = helix(k / 24.0);
    text += fmt::format("spline {:.9f} {:.9f} {:.9f} 0 {:.9f} {:.9f}\n", p.x(), p.y(), p.z(), p.y() / 20.0,
                        p.z() / 20.0);
  }
  const double e = 0.005;
  SpaceContour contour = readSpaceContour(text, "tube.xyz", e);
  for (const SpacePoint& point : contour.points) EXPECT_LT(nearest(point.p_mm, helix, 1000), 5e-4);
  for (const Side side : {Side::kLeft, Side::kRight}) {
    contour.side = side;
    const SpacePath path = offsetInSpace(contour, 0.2);
    std::size_t folds = 0;
    for (const SpaceJointReport& joint : path.joints) folds += joint.joint != SpaceJoint::kPlanar ? 1U : 0U;
    EXPECT_GT(folds, 50U);
    for (const SpacePoint& point : path.points) {
      const double d = nearest(point.p_mm, helix, 1000);
      EXPECT_NEAR(d, 0.2, e + 5e-4);
      EXPECT_NEAR(std::hypot(point.p_mm.y(), point.p_mm.z()), 20.0, e + 1.5e-3);
      EXPECT_NEAR(point.axis.x(), 0.0, 0.01);
    }
  }
}

TEST(SpaceCurve, ASplinePassesItsPointsWithOneSlopeAndOneBend) {
  const std::vector<SpacePoint> points{
      {{0, 0, 0}, {0, 0, 1}}, {{3, 1, 0}, {0, 0, 1}}, {{4, 5, 0}, {0, 0, 1}}, {{9, 6, 2}, {0, 0, 1}}};
  const std::vector<SpaceCubic> cubics = splineThrough(points);
  ASSERT_EQ(cubics.size(), 3U);
  const auto speed = [&](std::size_t i) { return (points[i + 1].p_mm - points[i].p_mm).norm(); };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((cubics[i].at(0.0) - points[i].p_mm).norm(), 1e-12);
    EXPECT_LT((cubics[i].at(1.0) - points[i + 1].p_mm).norm(), 1e-12);
    if (i == 2) break;
    const auto& a = cubics[i].p_mm;
    const auto& b = cubics[i + 1].p_mm;
    EXPECT_LT(((a[3] - a[2]) / speed(i) - (b[1] - b[0]) / speed(i + 1)).norm(), 1e-12);
    EXPECT_LT(((a[3] - 2.0 * a[2] + a[1]) / std::pow(speed(i), 2) -
               (b[2] - 2.0 * b[1] + b[0]) / std::pow(speed(i + 1), 2))
                  .norm(),
              1e-12);
  }
  const auto third = [&](std::size_t i) {
    const auto& p = cubics[i].p_mm;
    return Vector3d((p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0]) / std::pow(speed(i), 3));
  };
  EXPECT_LT((third(0) - third(1)).norm(), 1e-12);
  EXPECT_LT((third(1) - third(2)).norm(), 1e-12);
  // Three points: one parabola.
  const std::vector<SpaceCubic> two = splineThrough({points[0], points[1], points[2]});
  EXPECT_LT((two[1].p_mm[3] - 3.0 * two[1].p_mm[2] + 3.0 * two[1].p_mm[1] - two[1].p_mm[0]).norm(), 1e-12);
}

TEST(SpaceCurve, WhatIsNoArcOrTooTightIsRefusedByItsLine) {
  const TiltedFace face;
  const std::string begin = face.row(0, 0);
  const std::string end = face.row(10, 0);
  EXPECT_THAT(faultOf(begin + "via" + face.place(5, 0) + "\n" + end),
              HasSubstr("line 2: the arc's three points"));
  EXPECT_THAT(faultOf(begin + "via 1 2\n" + end), HasSubstr("line 2: 2 values instead of the three"));
  EXPECT_THAT(faultOf(begin + "via 1 2 3\n"), HasSubstr("needs a point before and a point behind"));
  EXPECT_THAT(faultOf(begin + "centre" + face.place(5, 0) + "90\n" + end), HasSubstr("mm beside the point"));
  EXPECT_THAT(faultOf(begin + "centre" + face.place(5, 0) + "400\n" + end), HasSubstr("a sweep of 400"));
  EXPECT_THAT(faultOf("0 0 0 0 0 1\nvia 5 1 3\n10 0 0 0 0 1\n"), HasSubstr("off the normal of the plane"));
  EXPECT_THAT(faultOf("0 0 0 0 0 1\nbezier 3 0 2 6 0 2\n9 0 0 0 0 1\n"),
              HasSubstr("off the right angle to its line"));
  EXPECT_THAT(faultOf("spline 0 0 0 0 0 1\nspline 1 0 0 0 0 1\n"), HasSubstr("three points in a row"));
  EXPECT_THAT(faultOf("spline 0 0 0 0 0 1\nspline 0 0 0 0 0 1\nspline 1 0 0 0 0 1\n"),
              HasSubstr("at one place"));
  EXPECT_THAT(faultOf(begin + "curve 0 0 0\n"), HasSubstr("'curve' is no number"));
  // A half circle of 0.5 mm with the beam inside, 0.6 mm off: one fault for all of its chords.
  const std::string tight = faultOf(begin + "centre" + face.place(0.5, 0) + "180\n" + face.row(1, 0), 0.6);
  EXPECT_THAT(tight, HasSubstr("tighter than the radius"));
  EXPECT_EQ(std::count(tight.begin(), tight.end(), '\n'), 0) << tight;
  EXPECT_THROW(readSpaceContour(begin + end, "f.xyz", 0.0), CompensationError);
}

TEST(LiteralJoints, BurnWhereTheProofSaysSoAndAreTheSameWhereTheyAreProved) {
  const double r = 0.1;
  const auto tried = [&](double alpha, double beta, double omega) {
    const double deg = kTurn / 360.0;
    const SpaceCorner corner = SpaceCorner::of({alpha * deg, beta * deg, omega * deg}, 40.0 * r, Side::kLeft);
    const SpacePath path = offsetInSpace(corner.contour(), r, {}, JointLaw::kPaper);
    const SpaceCheck whole = checkCorner(corner, path.points, r);
    const SpaceCheck joint = checkJoint(corner.contour(), path, path.joints[0], r);
    EXPECT_NEAR(whole.nearest_mm, joint.nearest_mm, 1e-4);
    EXPECT_NEAR(whole.missed_mm, joint.missed_mm, 1e-4);
    EXPECT_EQ(path.burns.empty(), joint.nearest_mm > r - 1e-6);
    EXPECT_LT(joint.off_surface_mm, 1e-9);
    return joint;
  };
  EXPECT_NEAR(tried(35.0, 65.0, 270.0).nearest_mm, r, 1e-9);    // Case 1, radius.
  EXPECT_NEAR(tried(35.0, 110.0, 200.0).nearest_mm, r, 1e-9);   // Case 2, parallel.
  EXPECT_LT(tried(86.25, 176.25, 270.0).nearest_mm, 0.12 * r);  // Case 3, intersection.
  EXPECT_GT(tried(110.0, 145.0, 200.0).missed_mm, 0.1 * r);     // Case 7, fixed length.
  EXPECT_NEAR(tried(60.0, 60.0, 240.0).nearest_mm, r, 1e-9);    // One point.
}

TEST(LiteralJoints, OneThatTheTextGivesNoPointsForIsRefused) {
  const double deg = kTurn / 360.0;
  const SpaceCorner corner = SpaceCorner::of({95.0 * deg, 170.0 * deg, 240.0 * deg}, 10.0, Side::kLeft);
  try {
    offsetInSpace(corner.contour(), 0.1, {}, JointLaw::kPaper);
    ADD_FAILURE();
  } catch (const CompensationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the paper's joint of fixed length has no point here"));
  }
}

}  // namespace
}  // namespace kerfbench::planner

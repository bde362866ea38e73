// SPDX-License-Identifier: Apache-2.0
// Inner corners whose legs are bowed: what the beam leaves of them, and when a corner is one.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/compensation/offset.h"
#include "shapes.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kRadius_mm = 0.1;
constexpr double kDegree = std::numbers::pi / 180.0;

/// A leg of the corner at the origin, from there on: it leaves in a direction and turns by 1 / radius to the
/// left.
struct Leg {
  double direction_rad{};
  double curvature_per_mm{};
  double length_mm{};

  [[nodiscard]] Vector2d at(double s_mm) const {
    const double turned = curvature_per_mm * s_mm;
    const Vector2d along(std::cos(direction_rad), std::sin(direction_rad));
    const Vector2d left(-along.y(), along.x());
    if (std::abs(turned) < 1e-9) return s_mm * along;
    return (std::sin(turned) * along + (1.0 - std::cos(turned)) * left) / curvature_per_mm;
  }
  [[nodiscard]] Vector2d leftAt(double s_mm) const {
    const double direction = direction_rad + curvature_per_mm * s_mm;
    return {-std::sin(direction), std::cos(direction)};
  }
};

/// A leg whose bow is `bow` beam radii in radius, > 0 away from the beam; 0: straight. It turns by 60 degrees
/// at most.
Leg legOf(double direction_rad, double sense, double bow) {
  if (bow == 0.0) return {direction_rad, 0.0, 20.0 * kRadius_mm};
  const double radius_mm = std::abs(bow) * kRadius_mm;
  return {direction_rad, -sense / (bow * kRadius_mm),
          std::min(20.0 * kRadius_mm, 60.0 * kDegree * radius_mm)};
}

/// A corner of an open cut that turns left, the beam to its left: it comes in along `in` backwards, goes out
/// by `out`.
struct Corner {
  Leg in, out;

  [[nodiscard]] Contour contour() const {
    const Vector2d from = in.at(in.length_mm);
    const Vector2d to = out.at(out.length_mm);
    const auto piece = [](const Vector2d& a, const Vector2d& b, double sweep_rad) {
      return sweep_rad == 0.0 ? test::line(a.x(), a.y(), b.x(), b.y())
                              : test::arc(a.x(), a.y(), b.x(), b.y(), sweep_rad);
    };
    return {{piece(from, Vector2d::Zero(), -in.curvature_per_mm * in.length_mm),
             piece(Vector2d::Zero(), to, out.curvature_per_mm * out.length_mm)},
            Side::kLeft,
            false};
  }
};

/// Where a disc of the beam's size touches both legs at once, by a search along one of them.
struct Touch {
  double in_mm{};
  double out_mm{};
  double depth_mm{};  ///< From the corner to the disc.
};

Touch touchOf(const Corner& corner) {
  constexpr double kStep_mm = 2e-5;
  std::vector<Vector2d> in;
  for (double s = 0.0; s <= corner.in.length_mm; s += 5.0 * kStep_mm) in.push_back(corner.in.at(s));
  double low = 0.0;
  double high = corner.out.length_mm;
  Touch touch;
  // The disc that rolls out of the corner along the one leg leaves the other one for good.
  while (high - low > kStep_mm) {
    touch.out_mm = 0.5 * (low + high);
    const Vector2d centre = corner.out.at(touch.out_mm) + kRadius_mm * corner.out.leftAt(touch.out_mm);
    const auto nearest =
        std::ranges::min_element(in, {}, [&](const Vector2d& p) { return (p - centre).norm(); });
    ((*nearest - centre).norm() < kRadius_mm ? low : high) = touch.out_mm;
    touch.in_mm = 5.0 * kStep_mm * static_cast<double>(nearest - in.begin());
    touch.depth_mm = centre.norm() - kRadius_mm;
  }
  return touch;
}

/// Turns along what stays uncut, towards the beam and away from it.
struct Turns {
  double towards_rad{};
  double away_rad{};
};

Turns turnsOf(const Corner& corner, const Touch& touch, double turn_rad) {
  Turns turns{turn_rad, 0.0};
  for (const double bend :
       {-corner.in.curvature_per_mm * touch.in_mm, corner.out.curvature_per_mm * touch.out_mm})
    (bend > 0.0 ? turns.towards_rad : turns.away_rad) += std::abs(bend);
  return turns;
}

TEST(InnerCorner, LosesWhatADiscLeavesWhateverTheBowOfItsLegs) {
  int rounded = 0;
  int sharp = 0;
  for (const double turn_deg : {20.0, 45.0, 90.0, 120.0, 140.0, 155.0}) {
    for (const double bow_in : {0.0, 3.0, 8.0, 40.0, -8.0, -40.0}) {
      for (const double bow_out : {0.0, 3.0, 8.0, 40.0, -8.0, -40.0}) {
        SCOPED_TRACE(::testing::Message() << turn_deg << " degrees, bows " << bow_in << " and " << bow_out);
        const double turn_rad = turn_deg * kDegree;
        const Corner corner{legOf(std::numbers::pi, -1.0, bow_in), legOf(turn_rad, 1.0, bow_out)};
        const Contour contour = healed(corner.contour(), 0.002);
        if (!contactFaults({contour}).empty())
          continue;  // Legs that bend towards each other until they meet.
        const Touch touch = touchOf(corner);
        if (touch.in_mm > 0.9 * corner.in.length_mm || touch.out_mm > 0.9 * corner.out.length_mm) continue;
        const Offset offset = offsetContours({contour}, kRadius_mm);
        ASSERT_EQ(offset.lost.size(), 1U);
        const LostStretch& lost = offset.lost.front();
        EXPECT_NEAR(lost.depth_mm, touch.depth_mm, 5e-4);
        EXPECT_NEAR(lost.length_mm, touch.in_mm + touch.out_mm, 5e-3);
        const Turns turns = turnsOf(corner, touch, turn_rad);
        // Beside the limits a search in steps decides nothing.
        if (std::abs(turns.towards_rad - 150.0 * kDegree) < 0.01) continue;
        const bool is_corner =
            turns.towards_rad < 150.0 * kDegree && 3.0 * turns.away_rad <= turns.towards_rad;
        EXPECT_EQ(lost.kind == LostStretch::Kind::kRounded, is_corner)
            << turns.towards_rad / kDegree << " towards the beam, " << turns.away_rad / kDegree << " away";
        ++(is_corner ? rounded : sharp);
      }
    }
  }
  EXPECT_GT(rounded, 100);
  EXPECT_GT(sharp, 20);
}

TEST(InnerCorner, WithALegCurvedByFiveDegreesIsRoundedLikeAStraightOne) {
  const Corner straight{legOf(std::numbers::pi, -1.0, 0.0), legOf(90.0 * kDegree, 1.0, 0.0)};
  Corner bowed = straight;
  bowed.out.curvature_per_mm = -5.0 * kDegree / bowed.out.length_mm;
  for (const Corner& corner : {straight, bowed}) {
    const Offset offset = offsetContours({healed(corner.contour(), 0.002)}, kRadius_mm);
    ASSERT_EQ(offset.lost.size(), 1U);
    EXPECT_EQ(offset.lost[0].kind, LostStretch::Kind::kRounded);
    EXPECT_NEAR(offset.lost[0].depth_mm, kRadius_mm * (std::numbers::sqrt2 - 1.0), 1e-3);
  }
}

/// Kinds of loss of a cut from left to right above which the beam runs, at the given radius.
std::vector<LostStretch::Kind> kindsOf(const std::vector<Vector2d>& places, double radius_mm) {
  Contour contour{{}, Side::kLeft, false};
  for (std::size_t i = 0; i + 1 < places.size(); ++i)
    contour.segments.push_back(
        test::line(places[i].x(), places[i].y(), places[i + 1].x(), places[i + 1].y()));
  std::vector<LostStretch::Kind> kinds;
  for (const LostStretch& lost : offsetContours({healed(contour, 0.002)}, radius_mm).lost)
    kinds.push_back(lost.kind);
  return kinds;
}

TEST(InnerCorner, IsNoNotchThatIsLostAsAWhole) {
  using enum LostStretch::Kind;
  // A notch of 90 degrees and 0.2 mm in a straight cut, under a beam that does not get into it.
  EXPECT_EQ(kindsOf({{-3, 0}, {-0.1, 0}, {0, -0.1}, {0.1, 0}, {3, 0}}, 0.4), std::vector{kNarrow});
  // The same notch under a beam that reaches its bottom's corner.
  EXPECT_EQ(kindsOf({{-3, 0}, {-0.1, 0}, {0, -0.1}, {0.1, 0}, {3, 0}}, 0.02), std::vector{kRounded});
  // A corner of 90 degrees with a pocket in it, and one with a chamfer.
  EXPECT_EQ(kindsOf({{-3, 0}, {-0.1, 0}, {0.2, -0.3}, {0.3, -0.2}, {0, 0.1}, {0, 3}}, 0.2),
            std::vector{kNarrow});
  EXPECT_EQ(kindsOf({{-3, 0}, {-0.05, 0}, {0, 0.05}, {0, 3}}, 0.2), std::vector{kRounded});
}

}  // namespace
}  // namespace kerfbench::planner

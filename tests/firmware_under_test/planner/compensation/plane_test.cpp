// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/compensation/curves.h"
#include "firmware_under_test/planner/compensation/offset.h"
#include "firmware_under_test/planner/compensation/plane_check.h"
#include "shapes.h"

namespace kerfbench::planner {
namespace {

using test::arc;
using test::circle;
using test::line;
using test::polygon;

constexpr double kPi = std::numbers::pi;

Contour closed(std::vector<Segment> segments, Side side) { return {std::move(segments), side, true}; }
Contour square(double half, Side side, int entity = 0) {
  return closed(polygon({{-half, -half}, {half, -half}, {half, half}, {-half, half}}, entity), side);
}

std::vector<std::vector<Segment>> pathsOf(const Offset& offset) {
  std::vector<std::vector<Segment>> paths;
  for (const BeamPath& path : offset.paths) paths.push_back(path.segments);
  return paths;
}

/// Offset of healed contours, which samples confirm.
Offset checked(std::vector<Contour> contours, double radius) {
  for (Contour& contour : contours) contour = healed(contour, 0.002);
  Offset offset = offsetContours(contours, radius);
  const PlaneCheck check = checkPlane(contours, pathsOf(offset), radius);
  EXPECT_TRUE(check.holds(radius)) << "nearest " << check.nearest_mm << " farthest " << check.farthest_mm
                                   << " missed " << check.missed_mm << " side " << check.right_side
                                   << " whole " << check.whole;
  return offset;
}

std::string refusal(std::vector<Contour> contours, double radius) {
  try {
    for (Contour& contour : contours) contour = healed(contour, 0.002);
    offsetContours(contours, radius);
  } catch (const CompensationError& error) {
    return error.what();
  }
  return {};
}

TEST(PlaneOffset, SquareOutsideIsExtendedToASquare) {
  const Offset offset = checked({square(5.0, Side::kRight)}, 0.25);
  ASSERT_EQ(offset.paths.size(), 1U);
  EXPECT_EQ(offset.paths[0].segments.size(), 4U);
  for (const Segment& side : offset.paths[0].segments) EXPECT_NEAR(side.lengthMm(), 10.5, 1e-9);
  EXPECT_EQ(offset.joints.size(), 4U);
  for (const Joint& joint : offset.joints) EXPECT_EQ(joint.kind, JointKind::kExtended);
  EXPECT_TRUE(offset.lost.empty());
}

TEST(PlaneOffset, SquareInsideIsShortenedAndItsCornersAreTold) {
  const Offset offset = checked({square(5.0, Side::kLeft)}, 0.25);
  ASSERT_EQ(offset.paths.size(), 1U);
  for (const Segment& side : offset.paths[0].segments) EXPECT_NEAR(side.lengthMm(), 9.5, 1e-9);
  ASSERT_EQ(offset.lost.size(), 4U);
  for (const LostStretch& lost : offset.lost) {
    EXPECT_EQ(lost.kind, LostStretch::Kind::kRounded);
    EXPECT_NEAR(lost.depth_mm, 0.25 * (std::sqrt(2.0) - 1.0), 1e-9);
    EXPECT_NEAR(lost.length_mm, 0.5, 1e-9);
    EXPECT_NEAR(lost.p_mm.cwiseAbs().minCoeff(), 5.0, 1e-9);
  }
}

TEST(PlaneOffset, SharpCornersGetAnArc) {
  const Contour triangle = closed(polygon({{0.0, 0.0}, {10.0, 0.0}, {0.0, 3.0}}), Side::kRight);
  const Offset offset = checked({triangle}, 0.5);
  EXPECT_EQ(offset.joints[0].kind, JointKind::kInserted);
  EXPECT_EQ(offset.joints[2].kind, JointKind::kExtended);
}

/// Tests each pair of neighbours with each kind of joint, on both sides.
TEST(PlaneOffset, AllJointsOfLinesAndArcs) {
  int shortened = 0;
  int extended = 0;
  int inserted = 0;
  for (int turn_deg = -165; turn_deg <= 165; turn_deg += 15) {
    for (const double first : {0.0, 0.8, -0.8}) {
      for (const double second : {0.0, 0.9, -0.9}) {
        for (const Side side : {Side::kLeft, Side::kRight}) {
          // Chords turned so that the tangents at the joint turn by turn_deg.
          const double a = -0.5 * first;
          const double b = turn_deg * kPi / 180.0 + 0.5 * second;
          const auto piece = [](double x0, double y0, double x1, double y1, double sweep) {
            return sweep == 0.0 ? line(x0, y0, x1, y1) : arc(x0, y0, x1, y1, sweep);
          };
          const Contour chain{{piece(-8.0 * std::cos(a), -8.0 * std::sin(a), 0.0, 0.0, first),
                               piece(0.0, 0.0, 6.0 * std::cos(b), 6.0 * std::sin(b), second)},
                              side,
                              false};
          if (!contactFaults({chain}).empty()) continue;
          const Offset offset = checked({chain}, 0.3);
          ASSERT_EQ(offset.joints.size(), 1U);
          EXPECT_NEAR(offset.joints[0].turn_rad, turn_deg * kPi / 180.0, 1e-9);
          const JointKind kind = offset.joints[0].kind;
          shortened += kind == JointKind::kShortened;
          extended += kind == JointKind::kExtended;
          inserted += kind == JointKind::kInserted;
          EXPECT_EQ(kind == JointKind::kTangent, turn_deg == 0);
          EXPECT_TRUE(offset.paths.size() == 1U || std::abs(turn_deg) > 120);
        }
      }
    }
  }
  EXPECT_GT(shortened, 150);
  EXPECT_GT(extended, 100);
  EXPECT_GT(inserted, 50);
}

TEST(PlaneOffset, RandomContoursOnBothSides) {
  std::mt19937 random(20260722);
  for (int i = 0; i < 60; ++i) {
    Contour contour = test::star(random, 3 + i % 23, 2.0, 9.0, 1.2);
    if (!contactFaults({contour}).empty()) continue;
    for (const Side side : {Side::kLeft, Side::kRight}) {
      contour.side = side;
      for (const double radius : {0.1, 0.4, 1.5}) {
        SCOPED_TRACE(testing::Message() << i << " radius " << radius << " left " << (side == Side::kLeft));
        checked({contour}, radius);
      }
    }
  }
}

TEST(PlaneOffset, RandomHolesInOutlines) {
  std::mt19937 random(7);
  for (int i = 0; i < 25; ++i) {
    Contour outline = test::star(random, 12, 9.0, 12.0, 0.4);
    Contour hole = test::star(random, 9, 4.0, 8.0, 0.5);
    Contour island = test::star(random, 7, 1.0, 3.0, 0.5, {0.3, 0.2});
    outline.side = Side::kRight;
    hole.side = Side::kLeft;
    island.side = Side::kRight;
    if (!contactFaults({outline, hole, island}).empty()) continue;
    SCOPED_TRACE(i);
    checked({outline, hole, island}, 0.3);
  }
}

TEST(PlaneOffset, CirclesGrowAndShrink) {
  EXPECT_NEAR(checked({closed({circle(1.0, 2.0, 3.0)}, Side::kRight)}, 0.2).paths[0].segments[0].radiusMm(),
              3.2, 1e-12);
  EXPECT_NEAR(checked({closed({circle(1.0, 2.0, 3.0)}, Side::kLeft)}, 0.2).paths[0].segments[0].radiusMm(),
              2.8, 1e-12);
}

TEST(PlaneOffset, AHoleSmallerThanTheKerfIsTold) {
  const Offset offset = offsetContours({closed({circle(1.0, 2.0, 0.2, 5)}, Side::kLeft)}, 0.25);
  EXPECT_TRUE(offset.paths.empty());
  ASSERT_EQ(offset.lost.size(), 1U);
  EXPECT_EQ(offset.lost[0].kind, LostStretch::Kind::kWhole);
  EXPECT_EQ(offset.lost[0].entities, std::vector<int>{5});
  EXPECT_NEAR(offset.lost[0].length_mm, 0.4 * kPi, 1e-9);
}

TEST(PlaneOffset, ANarrowSlotOfAnOutlineIsTold) {
  // A slot 0.4 mm wide and 3 mm deep in the top edge.
  const Contour outline = closed(
      polygon(
          {{0.0, 0.0}, {10.0, 0.0}, {10.0, 8.0}, {5.2, 8.0}, {5.2, 5.0}, {4.8, 5.0}, {4.8, 8.0}, {0.0, 8.0}}),
      Side::kRight);
  EXPECT_EQ(checked({outline}, 0.15).paths[0].segments.size(), 8U);
  const Offset offset = checked({outline}, 0.25);
  ASSERT_EQ(offset.lost.size(), 1U);
  EXPECT_EQ(offset.lost[0].kind, LostStretch::Kind::kNarrow);
  EXPECT_GT(offset.lost[0].depth_mm, 2.5);
  EXPECT_NEAR(offset.lost[0].p_mm.y(), 5.0, 1e-9);
}

TEST(PlaneOffset, AWaistDividesAHole) {
  // Two chambers with a neck of 0.3 mm.
  const Contour hole = closed(polygon({{0.0, 0.0},
                                       {4.0, 0.0},
                                       {4.0, 1.85},
                                       {5.0, 1.85},
                                       {5.0, 0.0},
                                       {9.0, 0.0},
                                       {9.0, 4.0},
                                       {5.0, 4.0},
                                       {5.0, 2.15},
                                       {4.0, 2.15},
                                       {4.0, 4.0},
                                       {0.0, 4.0}}),
                              Side::kLeft);
  EXPECT_EQ(checked({hole}, 0.1).paths.size(), 1U);
  const Offset offset = checked({hole}, 0.2);
  EXPECT_EQ(offset.paths.size(), 2U);
  int narrow = 0;
  for (const LostStretch& lost : offset.lost) narrow += lost.kind == LostStretch::Kind::kNarrow;
  EXPECT_EQ(narrow, 2);
}

TEST(PlaneOffset, ASlotExactlyAsWideAsTheKerfIsNotRunTwice) {
  const Contour hole = closed(polygon({{0.0, 0.0}, {5.0, 0.0}, {5.0, 0.5}, {0.0, 0.5}}), Side::kLeft);
  const Offset offset = offsetContours({hole}, 0.25);
  EXPECT_TRUE(offset.paths.empty());
  ASSERT_EQ(offset.lost.size(), 1U);
  EXPECT_EQ(offset.lost[0].kind, LostStretch::Kind::kWhole);
}

TEST(PlaneOffset, AFilletAsTightAsTheBeamAndTighter) {
  for (const double fillet : {0.3, 0.25, 0.2, 0.01}) {
    const double f = fillet;
    const Contour hole = closed({line(f, 0.0, 5.0, 0.0), line(5.0, 0.0, 5.0, 5.0), line(5.0, 5.0, 0.0, 5.0),
                                 line(0.0, 5.0, 0.0, f), arc(0.0, f, f, 0.0, 0.5 * kPi)},
                                Side::kLeft);
    const Offset offset = checked({hole}, 0.25);
    EXPECT_EQ(offset.paths.size(), 1U);
    EXPECT_EQ(offset.lost.size(), f < 0.25 ? 4U : 3U);
    for (const LostStretch& lost : offset.lost) EXPECT_EQ(lost.kind, LostStretch::Kind::kRounded);
  }
}

TEST(PlaneOffset, ACornerWithABowedLegIsACorner) {
  // A side that bends towards the beam by a few degrees leaves a little more of the corner than a straight
  // one.
  for (const double bow_deg : {1.0, 5.0, 12.0}) {
    const Contour hole = closed({arc(0.0, 0.0, 5.0, 0.0, -bow_deg / 180.0 * kPi), line(5.0, 0.0, 5.0, 5.0),
                                 line(5.0, 5.0, 0.0, 5.0), line(0.0, 5.0, 0.0, 0.0)},
                                Side::kLeft);
    const Offset offset = checked({hole}, 0.1);
    EXPECT_EQ(offset.paths.size(), 1U);
    EXPECT_EQ(offset.lost.size(), 4U);
    for (const LostStretch& lost : offset.lost)
      EXPECT_EQ(lost.kind, LostStretch::Kind::kRounded) << bow_deg << ": " << lost.depth_mm << " mm deep";
  }
}

TEST(PlaneOffset, APocketInACornerIsNoCorner) {
  // The corner at the origin reaches out along the diagonal, as wide as the kerf is not.
  const Contour hole = closed(
      polygon({{0.1, 0.0}, {5.0, 0.0}, {5.0, 5.0}, {0.0, 5.0}, {0.0, 0.1}, {-0.3, -0.2}, {-0.2, -0.3}}),
      Side::kLeft);
  const Offset offset = checked({hole}, 0.2);
  int narrow = 0;
  for (const LostStretch& lost : offset.lost) narrow += lost.kind == LostStretch::Kind::kNarrow;
  EXPECT_EQ(narrow, 1);
}

TEST(PlaneOffset, LabelsCloserThanTheKerfAreTold) {
  Contour a = square(2.0, Side::kRight, 10);
  Contour b = square(2.0, Side::kRight, 20);
  for (Segment& s : b.segments) {
    s.start_mm.x() += 4.3;
    s.end_mm.x() += 4.3;
  }
  EXPECT_EQ(checked({a, b}, 0.1).paths.size(), 2U);
  const Offset offset = checked({a, b}, 0.2);
  ASSERT_EQ(offset.lost.size(), 2U);
  for (const LostStretch& lost : offset.lost) {
    EXPECT_EQ(lost.kind, LostStretch::Kind::kNarrow);
    EXPECT_GT(lost.depth_mm, 1.0);
    EXPECT_NEAR(lost.p_mm.x(), 2.15, 0.16);
  }
}

TEST(PlaneOffset, CuspsOfArcsAreJoinedOnBothSides) {
  // Two arcs that leave each other tangentially: a cusp of 0 degrees that points to +x.
  const Contour drop =
      closed({arc(5.0, 0.0, 0.0, 2.0, -0.7), line(0.0, 2.0, 0.0, -2.0), arc(0.0, -2.0, 5.0, 0.0, -0.7)},
             Side::kRight);
  const double a0 = drop.segments[0].tangentAt(0.0).y();
  EXPECT_LT(std::abs(a0), 0.2);
  checked({drop}, 0.3);
  // Circles of radius 2 and 5 that touch at the origin from the same side.
  const Contour cusp{
      {arc(-2.0, 2.0, 0.0, 0.0, 0.5 * kPi), arc(0.0, 0.0, -4.0, 2.0, -2.0 * std::atan2(2.0, 4.0))},
      Side::kLeft,
      false};
  for (const Side side : {Side::kLeft, Side::kRight}) {
    Contour c = cusp;
    c.side = side;
    // Samples near the tip between the arcs do not show on which side of them they lie: the arcs are 1 um
    // apart.
    const Offset offset = side == Side::kLeft ? checked({c}, 0.3) : offsetContours({c}, 0.3);
    EXPECT_NEAR(std::abs(offset.joints[0].turn_rad), kPi, 1e-6);
    EXPECT_EQ(offset.joints[0].kind, side == Side::kLeft ? JointKind::kInserted : JointKind::kShortened);
    const PlaneCheck check = checkPlane({c}, pathsOf(offset), 0.3);
    EXPECT_NEAR(check.nearest_mm, 0.3, 2e-5);
    EXPECT_NEAR(check.farthest_mm, 0.3, 2e-5);
  }
}

TEST(PlaneOffset, GapsAndSliversOfTheDrawingDoNoHarm) {
  for (const double gap : {1e-9, 1e-7, 1e-6, 1e-4, 1.9e-3}) {
    for (const double angle : {0.0, 0.7, 1.5708, 2.5, 4.0, 5.5}) {
      Contour shape =
          closed({line(0.0, 0.0, 6.0, 0.0), arc(6.0, 0.0, 6.0, 4.0, kPi), arc(6.0, 4.0, 3.0, 4.0, -1.0),
                  arc(3.0, 4.0, 0.0, 4.0, 2.0), line(0.0, 4.0, 0.0, 0.0)},
                 Side::kRight);
      const Eigen::Vector2d by(gap * std::cos(angle), gap * std::sin(angle));
      for (std::size_t i : {1U, 3U}) {
        Segment& s = shape.segments[i];
        s.start_mm += by;
        s.end_mm += by;
        s.centre_mm += by;
      }
      SCOPED_TRACE(testing::Message() << gap << " " << angle);
      for (const Side side : {Side::kRight, Side::kLeft}) {
        shape.side = side;
        checked({shape}, 0.2);
      }
    }
  }
}

TEST(PlaneOffset, ManyShortSegmentsOfACurve) {
  // A wave of 400 chords a few micrometres to tenths of a millimetre long, closed by three lines.
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i <= 400; ++i) {
    const double x = 0.03 * i;
    corners.emplace_back(x, 1.0 + 0.8 * std::sin(3.0 * x));
  }
  corners.emplace_back(12.0, -3.0);
  corners.emplace_back(0.0, -3.0);
  for (const Side side : {Side::kLeft, Side::kRight}) {
    for (const double radius : {0.05, 0.1, 0.3}) checked({closed(polygon(corners), side)}, radius);
  }
}

/// Biarcs of a gentle curve have centres kilometres away: their distances come with rounding.
TEST(PlaneOffset, ArcsOfKilometres) {
  for (const double sweep : {1e-3, 3.4e-5, 1e-6, -3.4e-5}) {
    for (const double away : {0.0, 800.0}) {
      const double x = away;
      const double y = -away;
      const Contour shape =
          closed({arc(x, y, x + 8.0, y - 3.0, sweep), arc(x + 8.0, y - 3.0, x + 7.5, y + 4.0, 0.4),
                  arc(x + 7.5, y + 4.0, x + 3.0, y + 1.0, -sweep), arc(x + 3.0, y + 1.0, x, y, 1.2)},
                 Side::kLeft);
      for (const double radius : {0.05, 0.3, 0.7}) {
        Contour other = shape;
        other.side = Side::kRight;
        checked({shape}, radius);
        checked({other}, radius);
      }
    }
  }
}

TEST(PlaneOffset, EndsRoundedToTheFilesDecimalsDoNoHarm) {
  std::mt19937 random(99);
  for (int i = 0; i < 12; ++i) {
    Contour contour = test::star(random, 15, 4.0, 9.0, 1.0, {300.0, -200.0});
    for (Segment& s : contour.segments) {
      for (Eigen::Vector2d* p : {&s.start_mm, &s.end_mm}) *p = (*p * 1e3).array().round() / 1e3;
    }
    contour.side = i % 2 == 0 ? Side::kLeft : Side::kRight;
    if (contactFaults({healed(contour, 0.002)}).empty()) checked({contour}, 0.15);
  }
}

TEST(PlaneOffset, OpenChainsKeepTheirSideAndStopWhereTheyWouldBurn) {
  const Contour hook{polygon({{0.0, 0.0}, {5.0, 0.0}, {5.0, 0.3}, {0.0, 0.3}}), Side::kLeft, false};
  Contour open = hook;
  open.segments.pop_back();
  const Offset inside = checked({open}, 0.2);  // The contour lies between its own legs.
  EXPECT_TRUE(inside.paths.empty());
  EXPECT_FALSE(inside.lost.empty());
  open.side = Side::kRight;
  EXPECT_EQ(checked({open}, 0.2).paths.size(), 1U);
}

TEST(Hostile, ContoursThatTouchOrCrossThemselves) {
  const auto eight = polygon({{0.0, 0.0}, {4.0, 4.0}, {4.0, 0.0}, {0.0, 4.0}}, 3);
  EXPECT_NE(refusal({closed(eight, Side::kLeft)}, 0.1).find("E3 and E5 at (2.000, 2.000)"),
            std::string::npos);
  const auto spike = polygon({{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {4.0, 6.0}, {4.0, 4.0}, {0.0, 4.0}});
  EXPECT_NE(refusal({closed(spike, Side::kLeft)}, 0.1), "");
  const auto pinched = polygon({{0.0, 0.0}, {4.0, 0.0}, {2.0, 2.0}, {4.0, 4.0}, {0.0, 4.0}, {2.0, 2.0}});
  EXPECT_NE(refusal({closed(pinched, Side::kLeft)}, 0.1).find("(2.000, 2.000)"), std::string::npos);
  const auto onto_side = polygon({{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {2.0, 0.0}, {0.0, 4.0}});
  EXPECT_NE(refusal({closed(onto_side, Side::kLeft)}, 0.1), "");
}

TEST(Hostile, ContoursThatMeetAndShareEdges) {
  Contour a = square(2.0, Side::kRight, 0);
  Contour b = square(2.0, Side::kRight, 10);
  for (Segment& s : b.segments) {
    s.start_mm.x() += 4.0;
    s.end_mm.x() += 4.0;
  }
  EXPECT_NE(refusal({a, b}, 0.1).find("meets another one"), std::string::npos);
}

TEST(Hostile, NumbersThatAreNone) {
  Contour a = square(2.0, Side::kRight, 4);
  a.segments[1].end_mm.x() = std::nan("");
  EXPECT_NE(refusal({a}, 0.1).find("E5 holds a number that is not finite"), std::string::npos);
  a = square(2.0, Side::kRight);
  for (const double radius : {0.0, -1.0, double(NAN), double(INFINITY)}) EXPECT_NE(refusal({a}, radius), "");
  EXPECT_NE(refusal({Contour{}}, 0.1), "");
}

TEST(Hostile, ZeroLengthSegmentsVanish) {
  Contour a = square(2.0, Side::kRight);
  a.segments.insert(a.segments.begin() + 1, line(2.0, -2.0, 2.0, -2.0, 77));
  a.segments.insert(a.segments.begin() + 3, line(2.0, 2.0, 2.0, 2.0, 78));
  EXPECT_EQ(checked({a}, 0.2).paths[0].segments.size(), 4U);
}

TEST(Hostile, GapsAndCrookedArcsAreRefusedByPlace) {
  Contour a = square(2.0, Side::kRight, 4);
  a.segments[1].end_mm.y() -= 0.5;
  EXPECT_NE(refusal({a}, 0.1).find("E5 and E6 at (2.000, 1.500): a gap of 0.5000 mm"), std::string::npos);
  Contour b = closed({circle(0.0, 0.0, 2.0, 8)}, Side::kRight);
  b.segments[0].end_mm.x() += 0.1;
  EXPECT_NE(refusal({b}, 0.1).find("E8"), std::string::npos);
}

}  // namespace
}  // namespace kerfbench::planner

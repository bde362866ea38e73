// SPDX-License-Identifier: Apache-2.0
// Corners of cuts that are displaced, rounded and run over; ends of creases.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/vision/corner/corner_shape.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

constexpr double kPi = std::numbers::pi;

Vector2d along(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

constexpr double kReachMm = 0.4;

/// A right corner between the x and the y axis.
CornerShape rightCorner() { return {}; }

/// Shifts both legs as one.
void shift(CornerShape& shape, const Vector2d& by_mm) {
  for (CornerLeg* leg : {&shape.in, &shape.out})
    leg->offset_mm += by_mm.dot(Vector2d(-leg->outwards.y(), leg->outwards.x()));
}

TEST(CornerShape, OfAPerfectCornerDoesNotDeviate) { EXPECT_EQ(deviationMm(rightCorner(), kReachMm), 0.0); }

TEST(CornerShape, DeviatesByItsRoundingOrByWhatItRunsOver) {
  CornerShape shape = rightCorner();
  shape.rounding_mm = 0.06;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.06, 1e-4);
  shape.rounding_mm = 0.0;
  shape.in.over_mm = 0.07;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.07, 1e-9);
  shape.out.over_mm = 0.08;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.08, 1e-9);
}

TEST(CornerShape, DeviatesByWhatItIsCutTooShort) {
  CornerShape shape = rightCorner();
  shape.in.over_mm = -0.09;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.0, 1e-9) << "the other leg still reaches the corner";
  shape.out.over_mm = -0.05;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.05, 1e-9);
}

TEST(CornerShape, DeviatesByHowFarItsVertexIsDisplacedAlongTheBisector) {
  for (const double sign : {1.0, -1.0}) {
    CornerShape shape = rightCorner();
    shift(shape, sign * Vector2d(0.03, -0.03));
    EXPECT_NEAR(deviationMm(shape, kReachMm), std::hypot(0.03, 0.03), 1e-9) << sign;
  }
}

TEST(CornerShape, AddsRoundingToADisplacementInwardsAndTakesItFromOneOutwards) {
  const Vector2d outwards = Vector2d(1.0, -1.0).normalized();
  CornerShape shape = rightCorner();
  shape.rounding_mm = 0.04;
  shift(shape, -0.02 * outwards);
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.06, 1e-4);
  shift(shape, 0.04 * outwards);
  // The legs now lie farther off than the arc: 0.02 mm times the cosine of 45 degrees, and the arc 0.02 mm.
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.02, 1e-4);
}

TEST(CornerShape, DeviatesByALegThatSwaysAsFarAsItIsLookedAt) {
  CornerShape shape = rightCorner();
  shape.out.slope = 0.1;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.04, 1e-4);
  shape.out.curvature_per_mm = -0.5;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.01, 1e-4);
  shape.out.twist_per_mm2 = 3.0;
  EXPECT_NEAR(deviationMm(shape, kReachMm), 0.04 - 0.04 + 0.032, 1e-4);
}

TEST(CornerShape, OfLegsThatLieAsideMeetsWhereTheirLinesCross) {
  for (const double turn : {0.3 * kPi, -0.5 * kPi, 0.7 * kPi}) {
    CornerShape shape;
    shape.in.outwards = -along(0.4);
    shape.out.outwards = along(0.4 + turn);
    const Vector2d by(0.031, -0.017);
    shift(shape, by);
    EXPECT_LT((vertexOf(shape.in, shape.out) - by).norm(), 1e-12);
  }
}

TEST(CornerLeg, KnowsPlacesBesideACurve) {
  for (const double bend : {0.0, 0.2, -0.4}) {
    CornerLeg leg{.outwards = along(0.7), .bend_per_mm = bend, .offset_mm = 0.03};
    for (const double along_mm : {0.0, 0.1, 0.55}) {
      const CornerLeg::Place place = leg.placeOf(leg.at(along_mm));
      EXPECT_NEAR(place.along_mm, along_mm, 1e-12) << bend;
      EXPECT_NEAR(place.beside_mm, 0.03, 1e-12) << bend;
    }
  }
}

enum class Over { kBoth, kIn, kOut };

struct Asked {
  Vector2d shift_mm;
  double rounding_mm, over_mm;
  Over legs{Over::kBoth};
};

/// Eight corners of one turn in eight directions.
struct Corners {
  TwinCut cut;
  struct Way {
    Vector2d corner, in, out;
  };
  std::vector<Way> ways;

  Corners(double turn, const Asked& asked, std::uint64_t seed) {
    cut.seed = cut.camera.board_seed = seed;
    for (int i = 0; i < 8; ++i) {
      const Way way{{-12.0 + 8.0 * (i % 4), i < 4 ? 4.0 : -4.0}, along(0.8 * i), along(0.8 * i + turn)};
      ways.push_back(way);
      // Every other entity runs backwards.
      const Vector2d from = way.corner - 2.5 * way.in;
      const Vector2d to = way.corner + 2.5 * way.out;
      cut.share_of[cut.add(i % 2 == 0 ? dieline::LineCurve{from, way.corner}
                                      : dieline::LineCurve{way.corner, from})] = 0.0;
      cut.share_of[cut.add(i % 3 == 0 ? dieline::LineCurve{to, way.corner}
                                      : dieline::LineCurve{way.corner, to})] = 0.0;
    }
    const double radius_mm = asked.rounding_mm / (1.0 / std::cos(0.5 * turn) - 1.0);
    const double arc_mm = radius_mm * std::tan(0.5 * std::abs(turn));
    const double before_mm = arc_mm - (asked.legs == Over::kOut ? 0.0 : asked.over_mm);
    const double after_mm = arc_mm - (asked.legs == Over::kIn ? 0.0 : asked.over_mm);
    cut.also = [=, this](twin::Sheet& sheet) {
      for (const Way& way : ways) {
        const Vector2d corner = way.corner + asked.shift_mm;
        const Vector2d stop = corner - before_mm * way.in;
        cut.burn(sheet, corner - 2.5 * way.in, stop, 1.5);
        cut.burn(sheet, corner + after_mm * way.out, corner + 2.5 * way.out, 1.5);
        if (radius_mm <= 0.0) continue;
        const Vector2d centre = stop + std::copysign(radius_mm, turn) * Vector2d(-way.in.y(), way.in.x());
        const Vector2d from = stop - centre;
        cut.burn(sheet, dieline::ArcCurve{centre, radius_mm, std::atan2(from.y(), from.x()), turn}, 0.0, 1.5);
      }
    };
  }
};

TEST(KerfCorner, IsMeasuredAgainstItsOwnLegsWhereverTheCutLies) {
  for (const double turn : {0.5 * kPi, -0.4 * kPi}) {
    std::vector<double> roundings, overshoots, deviations, zs;
    std::uint64_t seed = 0;
    for (const Asked& asked : {Asked{{0.05, 0.02}, 0.0, 0.0}, Asked{{-0.03, 0.04}, 0.06, 0.0},
                               Asked{{0.04, -0.03}, 0.0, 0.06}, Asked{{0.0, 0.0}, 0.06, 0.0}}) {
      const Corners corners(turn, asked, ++seed);
      const KerfScan scan = corners.cut.scan();
      ASSERT_EQ(scan.corners.size(), 8U);
      for (const CornerKerf& corner : scan.corners) {
        ASSERT_TRUE(corner.found);
        const auto way = std::min_element(corners.ways.begin(), corners.ways.end(), [&](auto& a, auto& b) {
          return (a.corner - corner.p_S_mm).norm() < (b.corner - corner.p_S_mm).norm();
        });
        CornerShape shape;
        shape.in.outwards = -way->in;
        shape.out.outwards = way->out;
        shape.rounding_mm = asked.rounding_mm;
        shape.in.over_mm = shape.out.over_mm = asked.over_mm;
        shift(shape, asked.shift_mm);
        const double deviation = deviationMm(shape, kReachMm);
        roundings.push_back(corner.rounding_mm - asked.rounding_mm);
        overshoots.push_back(corner.overshoot_mm - asked.over_mm);
        deviations.push_back(corner.deviation_mm - deviation);
        zs.push_back(deviations.back() / corner.deviation_sigma_mm);
        // A value that is zero cannot be negative: half of all errors are missing.
        if (asked.rounding_mm > 0.0) zs.push_back(roundings.back() / corner.rounding_sigma_mm);
        if (asked.over_mm > 0.0) zs.push_back(overshoots.back() / corner.overshoot_sigma_mm);
      }
    }
    const test::Statistics r = test::statisticsOf(roundings);
    const test::Statistics o = test::statisticsOf(overshoots);
    const test::Statistics d = test::statisticsOf(deviations);
    const test::Statistics z = test::statisticsOf(zs);
    std::printf(
        "  turn %.2f: rounding %.2f +- %.2f um, overshoot %.2f +- %.2f um, deviation %.2f +- %.2f um, "
        "z %.2f\n",
        turn, 1e3 * r.mean, 1e3 * r.sigma, 1e3 * o.mean, 1e3 * o.sigma, 1e3 * d.mean, 1e3 * d.sigma,
        std::hypot(z.mean, z.sigma));
    EXPECT_LT(std::hypot(r.mean, r.sigma), 0.002);
    EXPECT_LT(std::hypot(o.mean, o.sigma), 0.002);
    EXPECT_LT(std::hypot(d.mean, d.sigma), 0.0025);
    EXPECT_LT(std::hypot(z.mean, z.sigma), 1.3);
  }
}

TEST(KerfCorner, IsRunOverWhereOneLegAloneRunsOver) {
  std::uint64_t seed = 20;
  std::vector<double> errors, zs;
  for (const Over legs : {Over::kIn, Over::kOut}) {
    const Corners corners(0.5 * kPi, {{0.0, 0.0}, 0.0, 0.06, legs}, ++seed);
    const KerfScan scan = corners.cut.scan();
    ASSERT_EQ(scan.corners.size(), 8U);
    for (const CornerKerf& corner : scan.corners) {
      ASSERT_TRUE(corner.found);
      for (const double mm : {corner.overshoot_mm, corner.deviation_mm}) errors.push_back(mm - 0.06);
      zs.push_back(errors[errors.size() - 2] / corner.overshoot_sigma_mm);
      zs.push_back(errors.back() / corner.deviation_sigma_mm);
      EXPECT_LT(corner.deviation_sigma_mm, 0.0045);
    }
  }
  const test::Statistics e = test::statisticsOf(errors);
  const test::Statistics z = test::statisticsOf(zs);
  std::printf("  %.2f +- %.2f um, z %.2f\n", 1e3 * e.mean, 1e3 * e.sigma, std::hypot(z.mean, z.sigma));
  EXPECT_LT(std::hypot(e.mean, e.sigma), 0.0025);
  EXPECT_LT(std::hypot(z.mean, z.sigma), 1.3);
}

/// Tests a line that turns by 90 degrees into an arc of 2.5 mm, to either side, drawn in any sense.
TEST(KerfCorner, WithACurvedLegIsHeldAgainstThatCurve) {
  constexpr double kRadiusMm = 2.5;
  std::vector<double> errors, zs;
  std::uint64_t seed = 50;
  for (const double side : {1.0, -1.0}) {
    for (const bool against : {false, true}) {
      TwinCut cut;
      cut.seed = cut.camera.board_seed = ++seed;
      const Vector2d shift(0.03, 0.02);
      for (int i = 0; i < 4; ++i) {
        const Vector2d corner(-12.0 + 8.0 * i, 1.0);
        const double heading = 0.7 * i + 0.2;
        const Vector2d in = along(heading);
        // The arc starts along `out` and bends to one side.
        const Vector2d out = along(heading + 0.5 * kPi);
        const Vector2d centre = corner + side * kRadiusMm * Vector2d(-out.y(), out.x());
        const Vector2d from = corner - centre;
        const double start = std::atan2(from.y(), from.x());
        const dieline::ArcCurve arc{centre, kRadiusMm, start, side * 1.2};
        const dieline::ArcCurve backwards{centre, kRadiusMm, start + side * 1.2, -side * 1.2};
        cut.share_of[cut.add(dieline::LineCurve{corner - 2.5 * in, corner})] = 0.0;
        cut.share_of[cut.add(against ? backwards : arc)] = 0.0;
        const auto before = cut.also;
        cut.also = [=, &cut](twin::Sheet& sheet) {
          if (before) before(sheet);
          cut.burn(sheet, corner + shift - 2.5 * in, corner + shift, 1.5);
          cut.burn(sheet, dieline::ArcCurve{centre + shift, kRadiusMm, start, side * 1.2}, 0.0, 1.5);
        };
      }
      const KerfScan scan = cut.scan();
      ASSERT_EQ(scan.corners.size(), 4U);
      for (const CornerKerf& corner : scan.corners) {
        ASSERT_TRUE(corner.found);
        errors.push_back(corner.deviation_mm - shift.norm());
        zs.push_back(errors.back() / corner.deviation_sigma_mm);
        EXPECT_LT(corner.rounding_mm, 0.012);
        EXPECT_LT(corner.overshoot_mm, 0.012);
      }
    }
  }
  const test::Statistics e = test::statisticsOf(errors);
  const test::Statistics z = test::statisticsOf(zs);
  std::printf("  %.2f +- %.2f um, z %.2f\n", 1e3 * e.mean, 1e3 * e.sigma, std::hypot(z.mean, z.sigma));
  EXPECT_LT(std::hypot(e.mean, e.sigma), 0.0025);
  EXPECT_LT(std::hypot(z.mean, z.sigma), 1.4);
}

TEST(KerfCorner, IsNotDisturbedByAKerfThatEndsBesideItsLeg) {
  const auto scanWith = [](bool neighbour) {
    Corners corners(0.5 * kPi, {{0.02, 0.03}, 0.05, 0.0}, 61);
    std::vector<dieline::LineCurve> others;
    for (const Corners::Way& way : corners.ways) {
      const Vector2d left(-way.out.y(), way.out.x());
      const Vector2d end = way.corner + 0.66 * way.out + 0.27 * left;
      if (neighbour) others.push_back({end, end + 1.5 * left});
    }
    for (const dieline::LineCurve& line : others) corners.cut.add(line);
    return corners.cut.scan();
  };
  const KerfScan alone = scanWith(false);
  const KerfScan beside = scanWith(true);
  ASSERT_EQ(alone.corners.size(), 8U);
  ASSERT_EQ(beside.corners.size(), 8U);
  for (std::size_t i = 0; i < alone.corners.size(); ++i) {
    ASSERT_TRUE(beside.corners[i].found);
    EXPECT_NEAR(beside.corners[i].deviation_mm, alone.corners[i].deviation_mm, 0.0015);
    EXPECT_NEAR(beside.corners[i].rounding_mm, alone.corners[i].rounding_mm, 0.004);
  }
}

TEST(KerfCorner, IsNotMovedByScorchOnOneSide) {
  const auto cut = [](double darkening, std::uint64_t seed) {
    Corners corners(0.5 * kPi, {{0.03, -0.02}, 0.05, 0.0}, seed);
    corners.cut.board.scorch = {.fluence_j_mm2 = 0.15, .darkening = darkening, .shift_mm = {0.06, 0.04}};
    return corners.cut.scan();
  };
  std::vector<double> moved;
  for (const std::uint64_t seed : {31U, 32U}) {
    const KerfScan clean = cut(0.0, seed);
    const KerfScan scorched = cut(0.3, seed);
    ASSERT_EQ(scorched.corners.size(), clean.corners.size());
    for (std::size_t i = 0; i < clean.corners.size(); ++i) {
      moved.push_back(scorched.corners[i].deviation_mm - clean.corners[i].deviation_mm);
    }
  }
  const test::Statistics m = test::statisticsOf(moved);
  std::printf("  moved %.2f +- %.2f um\n", 1e3 * m.mean, 1e3 * m.sigma);
  // Corners without the calipers' correction for scorch would move by 3 um.
  EXPECT_LT(std::hypot(m.mean, m.sigma), 0.0017);
}

TEST(KerfCorner, OfACreaseHasEndsWhereTheBeamStopped) {
  std::vector<double> errors, zs;
  std::uint64_t seed = 0;
  for (const double share : {0.55, 0.7, 0.85}) {
    TwinCut cut;
    cut.seed = cut.camera.board_seed = ++seed;
    for (int i = 0; i < 14; ++i) {
      const Vector2d t = along(i * 0.47 + 0.1);
      const Vector2d middle(-14.0 + 4.0 * (i % 7), i < 7 ? 4.0 : -4.0);
      cut.share_of[cut.add(dieline::LineCurve{middle - 1.7 * t, middle + 1.7 * t},
                           dieline::Process::kCrease)] = share;
    }
    const KerfScan scan = cut.scan();
    ASSERT_EQ(scan.ends.size(), 28U);
    std::vector<double> own;
    for (const LineEnd& end : scan.ends) {
      ASSERT_TRUE(end.found) << end.entity;
      own.push_back(end.gap_mm);
      errors.push_back(end.gap_mm);
      zs.push_back(end.gap_mm / end.sigma_mm);
    }
    const test::Statistics e = test::statisticsOf(own);
    std::printf("  share %.2f: bias %.2f um, sigma %.2f um\n", share, 1e3 * e.mean, 1e3 * e.sigma);
  }
  const test::Statistics e = test::statisticsOf(errors);
  const test::Statistics z = test::statisticsOf(zs);
  EXPECT_LT(std::abs(e.mean), 0.002);
  EXPECT_LT(std::hypot(z.mean, z.sigma), 1.3);
}

}  // namespace
}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
// Ends, corners, crossings, neighbours and small holes, compared with the model's cuts.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "tests/hil/vision/kerf_twin.h"
#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

constexpr double kPi = std::numbers::pi;

Vector2d along(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

double worstError(const TwinCut& cut, const KerfScan& scan, int id, double end_mm) {
  const dieline::Curve& curve = cut.dieline.entities.at(static_cast<std::size_t>(id)).curve;
  const EntityKerf& kerf = test::entityOf(scan, id);
  double worst = 0.0;
  for (const Caliper& c : kerf.calipers) {
    if (c.near_joint || !c.found) continue;
    if (!dieline::isClosed(curve) &&
        std::min(c.station_mm, kerf.calipers.back().station_mm - c.station_mm) < end_mm)
      continue;
    const auto told = cut.offset_mm.find(id);
    const double offset = told == cut.offset_mm.end() ? 0.0 : told->second;
    worst = std::max(worst, std::abs(c.offset_mm - cut.truth(scan, c, curve, offset)));
  }
  return worst;
}

/// Length of curve whose stations are near a joint.
double hiddenMm(const KerfScan& scan, int id) {
  const EntityKerf& kerf = test::entityOf(scan, id);
  const auto n = std::count_if(kerf.calipers.begin(), kerf.calipers.end(),
                               [](const Caliper& c) { return c.near_joint; });
  return static_cast<double>(n) * kerf.calipers.back().station_mm /
         static_cast<double>(kerf.calipers.size() - 1);
}

TEST(KerfJoint, FreeEndsAreMeasuredWhereTheBeamStopped) {
  std::vector<double> errors;
  std::vector<double> zs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const double rough_mm : {0.0, 0.004}) {
      TwinCut cut;
      cut.seed = cut.camera.board_seed = seed;
      cut.camera.roughness.rms_mm = rough_mm;
      std::vector<std::pair<Vector2d, Vector2d>> lines;
      std::vector<double> gaps;
      for (int i = 0; i < 14; ++i) {
        const Vector2d t = along(i * 0.47 + (i % 7 == 0 ? 0.0 : 0.1));
        const Vector2d middle(-14.0 + 4.0 * (i % 7), i < 7 ? 4.0 : -4.0);
        const int id = cut.add(dieline::LineCurve{middle - 1.7 * t, middle + 1.7 * t});
        cut.share_of[id] = 0.0;
        gaps.push_back(0.05 * (i % 5 - 2));
        lines.emplace_back(middle - 1.7 * t, middle + (1.7 - gaps.back()) * t);
      }
      cut.also = [&](twin::Sheet& sheet) {
        for (const auto& [from, to] : lines) cut.burn(sheet, from, to, cut.fluence_share);
      };
      const KerfScan scan = cut.scan();
      ASSERT_EQ(scan.ends.size(), 28U);
      for (const LineEnd& end : scan.ends) {
        ASSERT_TRUE(end.found) << end.entity;
        const double error = end.gap_mm - (end.at_start ? 0.0 : gaps[static_cast<std::size_t>(end.entity)]);
        errors.push_back(error);
        zs.push_back(error / end.sigma_mm);
      }
    }
  }
  const test::Statistics e = test::statisticsOf(errors);
  const test::Statistics z = test::statisticsOf(zs);
  std::printf("  %zu ends: bias %.2f um, sigma %.2f um, z %.2f +- %.2f\n", errors.size(), 1e3 * e.mean,
              1e3 * e.sigma, z.mean, z.sigma);
  EXPECT_LT(std::abs(e.mean), 0.002);
  EXPECT_GT(std::hypot(z.mean, z.sigma), 0.6);
  EXPECT_LT(std::hypot(z.mean, z.sigma), 1.2);
}

TEST(KerfJoint, AnEndThatIsFarTooShortIsMeasuredFromWhereTheKerfStops) {
  TwinCut cut;
  const int id = cut.add(dieline::LineCurve{{-5.0, 1.0}, {5.0, 1.2}});
  cut.share_of[id] = 0.0;
  cut.also = [&](twin::Sheet& sheet) { cut.burn(sheet, {-5.0, 1.0}, {2.0, 1.14}, 1.5); };
  const KerfScan scan = cut.scan();
  ASSERT_EQ(scan.ends.size(), 2U);
  for (const LineEnd& end : scan.ends) {
    EXPECT_TRUE(end.found);
    EXPECT_NEAR(end.gap_mm, end.at_start ? 0.0 : 3.0, 0.006);
  }
}

struct CornerCase {
  double turn_rad;
  double radius_mm;     // Radius of the path.
  double overshoot_mm;  // Overshoot of both legs.
};

TEST(KerfJoint, CornersTellRoundingAndOvershoot) {
  for (const double turn : {0.5 * kPi, 0.35 * kPi, 0.65 * kPi, -0.5 * kPi}) {
    std::vector<double> rounding_errors, overshoot_errors, zs;
    for (const CornerCase& asked : {CornerCase{turn, 0.0, 0.0}, CornerCase{turn, 0.2, 0.0},
                                    CornerCase{turn, 0.4, 0.0}, CornerCase{turn, 0.0, 0.06}}) {
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        TwinCut cut;
        cut.seed = seed;
        struct Way {
          Vector2d corner, in, out;
        };
        std::vector<Way> ways;
        for (int i = 0; i < 8; ++i) {
          const Way way{{-12.0 + 8.0 * (i % 4), i < 4 ? 4.0 : -4.0}, along(0.4 * i), along(0.4 * i + turn)};
          ways.push_back(way);
          cut.share_of[cut.add(dieline::LineCurve{way.corner - 2.5 * way.in, way.corner})] = 0.0;
          cut.share_of[cut.add(dieline::LineCurve{way.corner, way.corner + 2.5 * way.out})] = 0.0;
        }
        const double tangent_mm = asked.radius_mm * std::tan(0.5 * std::abs(turn));
        cut.also = [&](twin::Sheet& sheet) {
          for (const Way& way : ways) {
            const Vector2d stop = way.corner - (tangent_mm - asked.overshoot_mm) * way.in;
            const Vector2d start = way.corner + (tangent_mm - asked.overshoot_mm) * way.out;
            cut.burn(sheet, way.corner - 2.5 * way.in, stop, 1.5);
            cut.burn(sheet, start, way.corner + 2.5 * way.out, 1.5);
            if (asked.radius_mm > 0.0) {
              const double side = turn > 0.0 ? 1.0 : -1.0;
              const Vector2d left(-way.in.y(), way.in.x());
              const Vector2d centre = stop + side * asked.radius_mm * left;
              const Vector2d from = stop - centre;
              cut.burn(sheet,
                       dieline::ArcCurve{centre, asked.radius_mm, std::atan2(from.y(), from.x()), turn}, 0.0,
                       1.5);
            }
          }
        };
        const double true_rounding = asked.radius_mm * (1.0 / std::cos(0.5 * turn) - 1.0);
        const KerfScan scan = cut.scan();
        ASSERT_EQ(scan.corners.size(), 8U);
        for (const CornerKerf& corner : scan.corners) {
          ASSERT_TRUE(corner.found);
          EXPECT_NEAR(corner.turn_rad, turn, 1e-9);
          const double error_mm = corner.rounding_mm - true_rounding;
          // An arc of 0.4 mm that turns by this much takes away all that the picture holds of the legs: one
          // in ten is off by 0.01 to 0.1 mm, which its stated uncertainty has to tell.
          if (turn < 2.0 || asked.radius_mm < 0.3) rounding_errors.push_back(error_mm);
          overshoot_errors.push_back(corner.overshoot_mm - asked.overshoot_mm);
          if (asked.radius_mm > 0.0) zs.push_back(error_mm / corner.rounding_sigma_mm);
          if (asked.overshoot_mm > 0.0) zs.push_back(overshoot_errors.back() / corner.overshoot_sigma_mm);
        }
      }
    }
    const test::Statistics r = test::statisticsOf(rounding_errors);
    const test::Statistics o = test::statisticsOf(overshoot_errors);
    const test::Statistics zz = test::statisticsOf(zs);
    const double z = std::hypot(zz.mean, zz.sigma);
    std::printf("  turn %.2f: rounding bias %.2f sigma %.2f um; overshoot bias %.2f sigma %.2f um; z %.2f\n",
                turn, 1e3 * r.mean, 1e3 * r.sigma, 1e3 * o.mean, 1e3 * o.sigma, z);
    EXPECT_LT(std::hypot(r.mean, r.sigma), 0.002);
    EXPECT_LT(std::hypot(o.mean, o.sigma), 0.002);
    EXPECT_LT(z, 1.2);
  }
}

TEST(KerfJoint, ACornerWithAShortLegIsToldFromOneThatIsNotCut) {
  for (const double leg_mm : {0.72, 0.8, 1.05, 1.3}) {
    for (const bool is_cut : {true, false}) {
      TwinCut cut;
      const int leg = cut.add(dieline::LineCurve{{0.0, 0.0}, {0.0, leg_mm}});
      cut.add(dieline::LineCurve{{-4.0, 0.0}, {0.0, 0.0}});
      cut.add(dieline::LineCurve{{0.0, leg_mm}, {4.0, leg_mm}});
      if (!is_cut) cut.share_of[leg] = 0.0;
      const KerfScan scan = cut.scan();
      ASSERT_EQ(scan.corners.size(), 2U) << leg_mm;
      for (const CornerKerf& corner : scan.corners) {
        // 0.4 mm at either end belong to the joints, and a leg is told by two calipers 0.25 mm apart.
        EXPECT_EQ(corner.short_leg, leg_mm < 1.0) << leg_mm;
        EXPECT_EQ(corner.found, is_cut && leg_mm > 1.0) << leg_mm;
      }
    }
  }
}

TEST(KerfJoint, CrossingsHideOnlyWhatLiesUnderTheOtherKerf) {
  for (const double angle : {0.5 * kPi, 0.25 * kPi, 0.15 * kPi}) {
    TwinCut cut;
    const int a = cut.add(dieline::LineCurve{{-8.0, 0.1}, {8.0, 0.3}});
    const int b = cut.add(dieline::LineCurve{-6.0 * along(angle), 6.0 * along(angle)});
    cut.offset_mm[a] = 0.02;
    cut.offset_mm[b] = -0.03;
    const KerfScan scan = cut.scan();
    for (const int id : {a, b}) {
      std::printf("  crossing at %.0f degrees, E%d: hidden %.2f mm, worst error %.2f um\n",
                  angle * 180.0 / kPi, id, hiddenMm(scan, id), 1e3 * worstError(cut, scan, id, 0.3));
      EXPECT_LT(hiddenMm(scan, id), 0.85 / std::sin(angle));
      EXPECT_GT(hiddenMm(scan, id), 0.1);
      EXPECT_LT(worstError(cut, scan, id, 0.3), 0.002);
    }
  }
}

TEST(KerfJoint, NeighboursAndSmallHolesAreMeasured) {
  TwinCut cut;
  std::vector<int> ids;
  const auto add = [&](dieline::Curve curve, double offset) {
    ids.push_back(cut.add(std::move(curve)));
    cut.offset_mm[ids.back()] = offset;
  };
  add(dieline::LineCurve{{-14.0, 4.0}, {-6.0, 4.1}}, 0.02);
  add(dieline::LineCurve{{-14.0, 4.4}, {-6.0, 4.5}}, -0.02);
  double x = -14.0;
  for (const double r : {0.3, 0.35, 0.4, 0.5, 0.8, 1.2}) {
    add(dieline::ArcCurve{{x, -2.0}, r, 0.4, 2.0 * kPi}, 0.0);
    add(dieline::ArcCurve{{x, -6.0}, r, 0.4, -2.0 * kPi}, 0.01);
    x += 4.0;
  }
  const KerfScan scan = cut.scan();
  for (const int id : ids) {
    std::printf("  E%d: hidden %.2f mm, worst error %.2f um\n", id, hiddenMm(scan, id),
                1e3 * worstError(cut, scan, id, 0.3));
    EXPECT_EQ(hiddenMm(scan, id), 0.0) << "E" << id;
    EXPECT_LT(worstError(cut, scan, id, 0.3), 0.002) << "E" << id;
  }
}

TEST(KerfJoint, TangentContinuationIsMeasuredAsOrdinary) {
  TwinCut cut;
  const int a = cut.add(dieline::LineCurve{{-8.0, 0.0}, {0.0, 0.0}});
  const int b = cut.add(dieline::ArcCurve{{0.0, 3.0}, 3.0, -0.5 * kPi, 0.5 * kPi});
  const int c = cut.add(dieline::LineCurve{{3.0, 3.0}, {3.0, 8.0}});
  const KerfScan scan = cut.scan();
  for (const int id : {a, b, c}) {
    EXPECT_EQ(hiddenMm(scan, id), 0.0);
    EXPECT_LT(worstError(cut, scan, id, id == b ? 0.0 : 0.3), 0.002);
  }
  EXPECT_TRUE(scan.corners.empty());
  EXPECT_EQ(scan.ends.size(), 2U);  // The ends are those of the whole chain.
}

TEST(KerfJoint, ClosedCurvesTellTheirGap) {
  for (const double gap_mm : {0.0, 0.15, 0.3, 0.6}) {
    TwinCut cut;
    const double r = 3.0;
    cut.share_of[cut.add(dieline::ArcCurve{{0.0, 0.0}, r, 0.3, 2.0 * kPi})] = 0.0;
    cut.also = [&](twin::Sheet& sheet) {
      cut.burn(sheet, dieline::ArcCurve{{0.0, 0.0}, r, 0.3 + 0.5 * gap_mm / r, 2.0 * kPi - gap_mm / r}, 0.0,
               1.5);
    };
    const KerfScan scan = cut.scan();
    ASSERT_EQ(scan.ends.size(), 1U);
    ASSERT_TRUE(scan.ends[0].found);
    std::printf("  gap %.2f mm: %.4f +- %.4f\n", gap_mm, scan.ends[0].gap_mm, scan.ends[0].sigma_mm);
    // A wide gap of a small circle is seen along the tangent, from the place where the kerf has left it.
    EXPECT_NEAR(scan.ends[0].gap_mm, gap_mm, gap_mm > 0.5 ? 0.015 : 0.005);
  }
}

}  // namespace
}  // namespace kerfbench::vision

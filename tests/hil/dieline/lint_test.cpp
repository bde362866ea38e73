// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <numbers>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using Kind = LintFinding::Kind;

Dieline dielineOf(const std::vector<Curve>& curves, Process process = Process::kCut) {
  Dieline dieline;
  for (const Curve& curve : curves) {
    const int id = static_cast<int>(dieline.entities.size());
    dieline.entities.push_back({id, curve, process, "CUT", "line " + std::to_string(10 * id)});
  }
  return dieline;
}
int count(const Dieline& dieline, Kind kind) {
  int n = 0;
  for (const LintFinding& finding : lintDieline(dieline)) n += finding.kind == kind ? 1 : 0;
  return n;
}
int count(const std::vector<Curve>& curves, Kind kind) { return count(dielineOf(curves), kind); }

const std::vector<Curve> kSquare{LineCurve{{0, 0}, {10, 0}}, LineCurve{{10, 0}, {10, 10}},
                                 LineCurve{{10, 10}, {0, 10}}, LineCurve{{0, 10}, {0, 0}}};
std::vector<Curve> squareAnd(const Curve& curve) {
  std::vector<Curve> curves = kSquare;
  curves.push_back(curve);
  return curves;
}

TEST(Lint, ASoundSquareIsClean) { EXPECT_TRUE(lintDieline(dielineOf(kSquare)).empty()); }

TEST(Lint, FixturesAreClean) {
  for (const char* name :
       {"label-60x40.dxf", "tuck-end-carton.dxf", "coupon-perforated.dxf", "label-60x40-librecad.dxf",
        "label-60x40.svg", "label-60x40-turned.svg", "label-60x40-paths.svg"}) {
    for (const LintFinding& finding : lintDieline(readDieline(fixture(name), defaultLayerProfile()))) {
      ADD_FAILURE() << name << ": " << finding.message;
    }
  }
  const auto strip = lintDieline(readDieline(fixture("strip-crosscut.dxf"), defaultLayerProfile()));
  ASSERT_EQ(strip.size(), 1U);  // A cut across the web is open and is reported as such, but may be cut.
  EXPECT_EQ(strip[0].kind, Kind::kOpenOutline);
  EXPECT_FALSE(strip[0].is_error);
}

TEST(Lint, DuplicatesInEitherSenseAreErrors) {
  EXPECT_EQ(count(squareAnd(LineCurve{{10, 0}, {10, 10}}), Kind::kDuplicate), 1);
  EXPECT_EQ(count(squareAnd(LineCurve{{10, 10.001}, {10, 0}}), Kind::kDuplicate), 1);
  EXPECT_EQ(count(squareAnd(LineCurve{{10.02, 10}, {10.02, 0}}), Kind::kDuplicate), 0);
  const ArcCurve circle{{5, 5}, 2, 0, 2 * pi};
  EXPECT_EQ(count({circle, ArcCurve{{5, 5}, 2, 1, -2 * pi}}, Kind::kDuplicate), 1);
  EXPECT_EQ(count({circle, ArcCurve{{5, 5}, 2.02, 0, 2 * pi}}, Kind::kDuplicate), 0);
  BezierCurve b;
  b.control_mm << 0, 1, 8, 9, 0, 5, 5, 0;
  EXPECT_EQ(count({b, reversed(b)}, Kind::kDuplicate), 1);
  EXPECT_EQ(count({b, LineCurve{{0, 0}, {9, 0}}}, Kind::kDuplicate), 0);
  // A straight curve and a line are the same cut.
  b.control_mm << 0, 3, 6, 9, 0, 0, 0, 0;
  EXPECT_EQ(count({b, LineCurve{{9, 0}, {0, 0}}}, Kind::kDuplicate), 1);
}

TEST(Lint, AFindingTellsPlaceLayerAndEntities) {
  const auto findings = lintDieline(dielineOf(squareAnd(LineCurve{{10, 0}, {10, 10}})));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_TRUE(findings[0].is_error);
  EXPECT_EQ(findings[0].layer, "CUT");
  EXPECT_LT((findings[0].p_mm - Vector2d(10, 5)).norm(), 1e-9);
  EXPECT_THAT(findings[0].message, testing::HasSubstr("E4 (line 40, cut) repeats E1 (line 10, cut)"));
}

TEST(Lint, OverlapsOfLines) {
  const auto overlaps = [](const Curve& a, const Curve& b) { return count({a, b}, Kind::kOverlap); };
  const LineCurve base{{0, 0}, {30, 40}};
  EXPECT_EQ(overlaps(base, LineCurve{{15, 20}, {45, 60}}), 1);
  EXPECT_EQ(overlaps(base, LineCurve{{6, 8}, {3, 4}}), 1);  // The line lies inside, in the opposite sense.
  EXPECT_EQ(overlaps(base, LineCurve{{30, 40}, {45, 60}}), 0);  // The lines lie end to end.
  // An overlap of 5 um is below the limit.
  EXPECT_EQ(overlaps(base, LineCurve{{29.997, 39.996}, {45, 60}}), 0);
  EXPECT_EQ(overlaps(base, LineCurve{{29.97, 39.96}, {45, 60}}), 1);  // An overlap of 50 um is not.
  EXPECT_EQ(overlaps(base, LineCurve{{15.02, 20}, {45.02, 60}}), 0);  // The line lies next to it.
  EXPECT_EQ(overlaps(base, LineCurve{{0, 40}, {30, 0}}), 0);          // The line lies across it.
}

TEST(Lint, OverlapsOfArcs) {
  const auto overlaps = [](const Curve& a, const Curve& b) { return count({a, b}, Kind::kOverlap); };
  const ArcCurve base{{1, 2}, 10, 0, pi};
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2}, 10, pi / 2, pi}), 1);
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2}, 10, -0.5, 1}), 1);
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2}, 10, 0.1, -0.2}), 1);
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2}, 10, pi, pi}), 0);  // The arc is the other half.
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2}, 10.02, 0, 1}), 0);
  EXPECT_EQ(overlaps(base, ArcCurve{{1, 2.02}, 10, 0, 1}), 0);
}

TEST(Lint, GapsBetweenEnds) {
  const auto gaps = [](double gap_mm) {
    std::vector<Curve> curves = kSquare;
    curves.back() = LineCurve{{0, 10}, {0, gap_mm}};
    return count(curves, Kind::kGap);
  };
  EXPECT_EQ(gaps(0.0005), 0);
  EXPECT_EQ(gaps(0.002), 1);
  EXPECT_EQ(gaps(0.49), 1);
  EXPECT_EQ(gaps(0.51), 0);
  // A pair of loose ends is one gap, in whatever cells they lie.
  EXPECT_EQ(count({LineCurve{{0, 0}, {4.9, 0}}, LineCurve{{5.1, 0}, {20, 0}}}, Kind::kGap), 1);
  // The end of a line on the middle of another one meets it: a tee.
  EXPECT_EQ(count({LineCurve{{0, 0}, {10, 0}}, LineCurve{{9.8, 0}, {9.8, 5}}}, Kind::kGap), 0);
  // Dashes of a perforation are intended.
  EXPECT_EQ(count(dielineOf({LineCurve{{0, 0}, {3, 0}}, LineCurve{{3.3, 0}, {6, 0}}}, Process::kPerforation),
                  Kind::kGap),
            0);
}

TEST(Lint, ZeroLength) {
  EXPECT_EQ(count(squareAnd(LineCurve{{3, 3}, {3, 3.0005}}), Kind::kZeroLength), 1);
  EXPECT_EQ(count(squareAnd(LineCurve{{3, 3}, {3, 3.002}}), Kind::kZeroLength), 0);
}

TEST(Lint, OpenOutlines) {
  std::vector<Curve> open = kSquare;
  open.pop_back();
  EXPECT_EQ(count(open, Kind::kOpenOutline), 1);
  EXPECT_EQ(count(kSquare, Kind::kOpenOutline), 0);
  EXPECT_EQ(count(squareAnd(LineCurve{{5, 0}, {5, 10}}), Kind::kOpenOutline), 0);  // Tees at both ends.
  EXPECT_EQ(count(squareAnd(LineCurve{{5, 0}, {5, 5}}), Kind::kOpenOutline), 1);
  EXPECT_EQ(count({ArcCurve{{5, 5}, 2, 0, 2 * pi}}, Kind::kOpenOutline), 0);
  EXPECT_EQ(count(dielineOf(open, Process::kCrease), Kind::kOpenOutline), 0);  // Creases need not close.
}

TEST(Lint, SuspiciousSizeAndNothingAtAll) {
  EXPECT_EQ(count({ArcCurve{{0, 0}, 0.9, 0, 2 * pi}}, Kind::kSuspiciousSize), 1);
  EXPECT_EQ(count({ArcCurve{{0, 0}, 1.1, 0, 2 * pi}}, Kind::kSuspiciousSize), 0);
  EXPECT_EQ(count({LineCurve{{0, 0}, {3001, 0}}}, Kind::kSuspiciousSize), 1);
  EXPECT_EQ(count({LineCurve{{0, 0}, {2999, 0}}}, Kind::kSuspiciousSize), 0);
  EXPECT_EQ(count(std::vector<Curve>{}, Kind::kEmpty), 1);
  EXPECT_EQ(count(dielineOf(kSquare, Process::kIgnore), Kind::kEmpty), 1);
  EXPECT_EQ(count(kSquare, Kind::kEmpty), 0);
}

TEST(Lint, IgnoredEntitiesAreNotChecked) {
  Dieline dieline = dielineOf(squareAnd(LineCurve{{10, 0}, {10, 10}}));
  dieline.entities.back().process = Process::kIgnore;
  EXPECT_TRUE(lintDieline(dieline).empty());
}

TEST(Lint, ASheetOfManyPartsTakesItsTimeOnly) {
  std::vector<Curve> curves;
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 50; ++k) {
      for (const Curve& curve : kSquare) {
        curves.push_back(transformed(curve, Eigen::Affine2d(Eigen::Translation2d(12.0 * i, 12.0 * k))));
      }
    }
  }
  ASSERT_EQ(curves.size(), 10000U);
  EXPECT_TRUE(lintDieline(dielineOf(curves)).empty());
}

TEST(Lint, ManyCopiesOfOneLineAreOneFindingEach) {
  const LintReport report =
      lintDieline(dielineOf(std::vector<Curve>(20000, LineCurve{{0, 0}, {10, 10}})), 20);
  EXPECT_EQ(report.counts.at(Kind::kDuplicate).all, 19999U);
  EXPECT_EQ(report.findings.size(), 20U);
  EXPECT_THAT(uncounted(report), testing::ElementsAre("duplicate: and 19979 more that are no worse"));
}

TEST(Lint, TheWorstAreNamedFirst) {
  std::vector<Curve> curves;
  for (int i = 0; i < 40; ++i) {
    const double y = 3.0 * i;
    curves.emplace_back(LineCurve{{0, y}, {20, y}});
    curves.emplace_back(LineCurve{{20.0 - 0.1 * (i + 1), y}, {40, y}});
  }
  const LintReport report = lintDieline(dielineOf(curves), 5);
  EXPECT_EQ(report.counts.at(Kind::kOverlap).all, 40U);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(report.findings.at(static_cast<std::size_t>(i)).size_mm, 0.1 * (40 - i), 1e-9);
}

TEST(Lint, OnlyWhatTouchesNoCutMayBeAccepted) {
  Dieline dieline = dielineOf(squareAnd(LineCurve{{10, 0}, {10, 0.24}}));
  dieline.entities.back().process = Process::kCrease;
  const std::set<Kind> accepted{Kind::kOverlap};
  const LintReport crease = lintDieline(dieline, 20);
  ASSERT_EQ(crease.counts.at(Kind::kOverlap).all, 1U);
  EXPECT_TRUE(isAccepted(crease.findings.at(0), accepted));
  EXPECT_FALSE(isAccepted(crease.findings.at(0), {Kind::kGap}));
  EXPECT_THAT(acceptedSentences(crease, accepted),
              testing::ElementsAre(testing::HasSubstr("overlap: 1 accepted")));
  dieline.entities.back().process = Process::kCut;
  const LintReport cut = lintDieline(dieline, 20);
  EXPECT_FALSE(isAccepted(cut.findings.at(0), accepted));
  EXPECT_TRUE(acceptedSentences(cut, accepted).empty());
  // A cut on a cut is told first, however small it is beside what may be accepted.
  dieline.entities.push_back({5, LineCurve{{0, 2}, {0, 9}}, Process::kCrease, "CREASE", "line 50"});
  EXPECT_FALSE(lintDieline(dieline, 1).findings.at(0).may_be_accepted);
}

TEST(Lint, KindsHaveOneNameEach) {
  for (const char* name :
       {"duplicate", "overlap", "gap", "zero-length", "open-outline", "suspicious-size", "empty"}) {
    const auto kind = lintKindFromName(name);
    ASSERT_TRUE(kind) << name;
    EXPECT_EQ(lintName(*kind), name);
  }
  EXPECT_FALSE(lintKindFromName("gaps"));
}

TEST(Lint, AmongManyOpenLinesEachFaultIsFound) {
  std::vector<Curve> curves;
  for (int i = 0; i < 150; ++i) {
    for (int k = 0; k < 150; ++k)
      curves.emplace_back(LineCurve{{3.0 * i, 3.0 * k}, {3.0 * i, 3.0 * k + 1.6}});
  }
  curves.push_back(curves[777]);
  const auto& touched = std::get<LineCurve>(curves[1234]);
  const Vector2d middle_mm = 0.5 * (touched.start_mm + touched.end_mm);
  curves.emplace_back(LineCurve{middle_mm, middle_mm + Vector2d(1, 0)});
  std::map<Kind, int> found;
  for (const LintFinding& finding : lintDieline(dielineOf(curves))) ++found[finding.kind];
  // A line and its copy meet at both ends; of the line that begins on another only one end is loose.
  EXPECT_THAT(found, testing::ElementsAre(testing::Pair(Kind::kDuplicate, 1),
                                          testing::Pair(Kind::kOpenOutline, 150 * 150 - 1 + 1)));
}

}  // namespace
}  // namespace kerfbench::dieline

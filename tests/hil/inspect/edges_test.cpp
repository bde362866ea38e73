// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/edges/edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using Edge = Tolerances::Edge;

constexpr double kHalf_mm = 0.105;  // Half the width of SyntheticRun's kerf.

dieline::Dieline drawingOf(const std::vector<dieline::Curve>& curves) {
  dieline::Dieline dieline;
  for (const dieline::Curve& curve : curves)
    dieline.entities.push_back(
        {static_cast<int>(dieline.entities.size()), curve, dieline::Process::kCut, "CUT", ""});
  return dieline;
}

/// Whether the kerf's side of an entity is nearer to `p_mm` than the curve itself.
bool kerfIsTowards(const dieline::Dieline& dieline, const checks::EdgeSides& sides, int id,
                   const Eigen::Vector2d& p_mm) {
  const dieline::Curve& curve = dieline.entities[static_cast<std::size_t>(id)].curve;
  const Eigen::Vector2d t = dieline::tangentAt(curve, 0.5);
  const Eigen::Vector2d towards = p_mm - dieline::pointAt(curve, 0.5);
  return sides.side[static_cast<std::size_t>(id)] * towards.dot(Eigen::Vector2d(-t.y(), t.x())) > 0.0;
}

TEST(KerfSides, FollowNestingWhateverTheSenseOfTheCurves) {
  // The dieline is a triangle drawn without a common sense, a hole in it, an island in the hole.
  const double turn = 2.0 * std::numbers::pi;
  const dieline::Dieline dieline =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{30, 50}, {60, 0}},
                 dieline::LineCurve{{30, 50}, {0, 0}}, dieline::ArcCurve{{30, 20}, 8, 0, -turn},
                 dieline::ArcCurve{{30, 20}, 3, 0, turn}});
  const Eigen::Vector2d middle(30, 20);
  const auto nesting = checks::kerfSides(dieline, Edge::kNesting);
  const auto outside = checks::kerfSides(dieline, Edge::kOutside);
  const auto inside = checks::kerfSides(dieline, Edge::kInside);
  EXPECT_EQ(nesting.outlines, 2);
  EXPECT_EQ(nesting.holes, 1);
  EXPECT_TRUE(nesting.problems.empty());
  for (int id = 0; id < 5; ++id) {
    EXPECT_EQ(kerfIsTowards(dieline, nesting, id, middle), id == 3) << id;
    EXPECT_FALSE(kerfIsTowards(dieline, outside, id, middle)) << id;
    EXPECT_TRUE(kerfIsTowards(dieline, inside, id, middle)) << id;
  }
}

TEST(KerfSides, OpenCutsAndOtherProcessesHaveNone) {
  dieline::Dieline dieline =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{60, 0}, {60, 40}},
                 dieline::ArcCurve{{15, 20}, 6, 0, 2 * std::numbers::pi}});
  dieline.entities[2].process = dieline::Process::kCrease;
  const auto sides = checks::kerfSides(dieline, Edge::kNesting);
  EXPECT_EQ(sides.side, (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(sides.open, 2);
}

TEST(KerfSides, OpenCutsHaveTheSideThatIsOrderedAlongTheFirstOfThem) {
  using Open = Tolerances::OpenCuts;
  // Three lines end to end: the first is the middle one, the second leads to it against its sense, the third
  // goes on.
  const dieline::Dieline dieline = drawingOf(
      {dieline::LineCurve{{10, 0}, {20, 0}}, dieline::LineCurve{{10, 0}, {0, 5}},
       dieline::LineCurve{{20, 0}, {30, 5}}, dieline::ArcCurve{{15, 20}, 6, 0, 2 * std::numbers::pi}});
  const auto sidesOf = [&](Open side) { return checks::kerfSides(dieline, Edge::kNesting, side).side; };
  EXPECT_EQ(sidesOf(Open::kLeft), (std::vector<int>{1, -1, 1, -1}));
  EXPECT_EQ(sidesOf(Open::kRight), (std::vector<int>{-1, 1, -1, -1}));
  EXPECT_EQ(sidesOf(Open::kCentre), (std::vector<int>{0, 0, 0, -1}));
  EXPECT_EQ(checks::kerfSides(dieline, Edge::kCentre, Open::kLeft).side, (std::vector<int>{0, 0, 0, 0}));
  dieline::Dieline part = dieline;
  part.entities[0].left_out = std::exchange(part.entities[0].process, dieline::Process::kIgnore);
  const auto sides = checks::kerfSides(part, Edge::kNesting, Open::kLeft);
  EXPECT_EQ(sides.side, (std::vector<int>{0, -1, 1, -1}));
  EXPECT_EQ(sides.open, 0);
  EXPECT_EQ(sides.open_beside, 2);
}

TEST(KerfSides, CutsThatBranchAreAProblem) {
  const dieline::Dieline dieline =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{60, 0}, {30, 40}},
                 dieline::LineCurve{{30, 40}, {0, 0}}, dieline::LineCurve{{60, 0}, {90, 0}}});
  EXPECT_FALSE(checks::kerfSides(dieline, Edge::kNesting).problems.empty());
  SyntheticRun run;
  run.dieline.entities[kHole].curve = dieline::LineCurve{{0, 0}, {20, 20}};
  run.limits.edge = Edge::kNesting;
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

/// As a selection of these entities leaves the drawing.
void keepOnly(dieline::Dieline& dieline, const std::vector<int>& ids) {
  for (dieline::Entity& entity : dieline.entities) {
    if (std::ranges::find(ids, entity.id) != ids.end() || entity.process == dieline::Process::kIgnore)
      continue;
    entity.left_out = std::exchange(entity.process, dieline::Process::kIgnore);
  }
}

TEST(KerfSides, OfASelectionAreThoseOfTheWholeDrawing) {
  const double turn = 2.0 * std::numbers::pi;
  const dieline::Dieline whole =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{30, 50}, {60, 0}},
                 dieline::LineCurve{{30, 50}, {0, 0}}, dieline::ArcCurve{{30, 20}, 8, 0, -turn},
                 dieline::ArcCurve{{30, 20}, 3, 0, turn}, dieline::ArcCurve{{90, 20}, 8, 0, turn}});
  for (const Edge edge : {Edge::kNesting, Edge::kOutside, Edge::kInside}) {
    const auto all = checks::kerfSides(whole, edge);
    for (const std::vector<int>& ids : std::vector<std::vector<int>>{
             {3}, {0, 1, 2}, {0, 1, 2, 3}, {4}, {3, 4}, {1}, {0, 2, 5}, {5}, {3, 5}}) {
      dieline::Dieline part = whole;
      keepOnly(part, ids);
      const auto sides = checks::kerfSides(part, edge);
      for (int id = 0; id < 6; ++id) {
        const bool is_kept = std::ranges::find(ids, id) != ids.end();
        const auto i = static_cast<std::size_t>(id);
        EXPECT_EQ(sides.side[i], is_kept ? all.side[i] : 0) << id;
      }
      EXPECT_EQ(sides.open, 0);
      EXPECT_TRUE(sides.problems.empty());
    }
  }
  dieline::Dieline hole = whole;
  keepOnly(hole, {3});
  EXPECT_EQ(checks::kerfSides(hole, Edge::kNesting).holes, 1);
  EXPECT_EQ(checks::kerfSides(hole, Edge::kNesting).outlines, 0);
  for (std::size_t i = 0; i < 3; ++i) hole.entities[i].left_out.reset();  // A layer that is ignored.
  EXPECT_EQ(checks::kerfSides(hole, Edge::kNesting).holes, 0);
}

TEST(KerfSides, CutsThatBranchAreAProblemThoughNotSelected) {
  dieline::Dieline dieline =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{60, 0}, {30, 40}},
                 dieline::LineCurve{{30, 40}, {0, 0}}, dieline::LineCurve{{60, 0}, {90, 0}},
                 dieline::ArcCurve{{30, 15}, 3, 0, 2.0 * std::numbers::pi}});
  keepOnly(dieline, {4});
  const auto sides = checks::kerfSides(dieline, Edge::kNesting);
  EXPECT_EQ(sides.open, 0);
  ASSERT_FALSE(sides.problems.empty());
  EXPECT_NE(sides.problems[0].find("not selected"), std::string::npos);
}

TEST(KerfSides, OfCutsThatBranchEachIsToldWhetherItIsSelected) {
  dieline::Dieline dieline =
      drawingOf({dieline::LineCurve{{0, 0}, {60, 0}}, dieline::LineCurve{{60, 0}, {30, 40}},
                 dieline::LineCurve{{30, 40}, {0, 0}}, dieline::LineCurve{{60, 0}, {90, 0}}});
  keepOnly(dieline, {3});
  const auto sides = checks::kerfSides(dieline, Edge::kNesting);
  EXPECT_EQ(sides.problems.size(), 3U);
  for (const std::string& problem : sides.problems) {
    const bool of_selected = problem.find("the cut E3") != std::string::npos;
    EXPECT_EQ(problem.find("not selected") == std::string::npos, of_selected) << problem;
  }
}

/// A run whose kerfs lie by `shift_mm` on the side that nesting requires.
SyntheticRun displaced(double shift_mm, double width_change_mm = 0.0) {
  SyntheticRun run;
  const auto sides = checks::kerfSides(run.dieline, Edge::kNesting);
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    const int side = sides.side[static_cast<std::size_t>(kerf.entity)];
    for (vision::Caliper& c : kerf.calipers) {
      c.offset_mm += side * shift_mm;
      c.width_mm += std::abs(side) * width_change_mm;
    }
    if (side == 0) continue;
    const dieline::Curve& curve = run.dieline.entities[static_cast<std::size_t>(kerf.entity)].curve;
    if (std::holds_alternative<dieline::LineCurve>(curve)) {
      const Eigen::Vector2d t = dieline::tangentAt(curve, 0.5);
      const Eigen::Vector2d shift = side * shift_mm * Eigen::Vector2d(-t.y(), t.x());
      run.shiftSpot(kerf.unit, kerf.entity, [=](double) { return shift; });
    }
  }
  run.limits.edge = Edge::kNesting;
  return run;
}

TEST(Edges, AKerfBesideTheLinePassesByItsEdgeAndOnTheLineFails) {
  const auto good = displaced(kHalf_mm).inspected();
  const Check& edge = checkOf(good, "edge");
  EXPECT_EQ(edge.verdict, Verdict::kPass) << edge.explanation;
  EXPECT_LT(edge.value + edge.u, 0.01);
  EXPECT_FALSE(hasCheck(good, "path"));
  EXPECT_EQ(checkOf(good, "stillness_x").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(good, "laser_timing").value, 0.0);
  EXPECT_EQ(checkOf(good, "spot_path").verdict, Verdict::kFail) << "the hole's spots stayed on the line";

  for (const double shift_mm : {0.0, -kHalf_mm}) {
    const auto bad = displaced(shift_mm).inspected();
    EXPECT_EQ(checkOf(bad, "edge").verdict, Verdict::kFail);
    EXPECT_NEAR(checkOf(bad, "edge").value, kHalf_mm - shift_mm, 0.01);
  }
}

/// A run of the hole alone, its kerf by `shift_mm` inside of its line.
SyntheticRun holeAlone(double shift_mm) {
  SyntheticRun run = displaced(shift_mm);
  keepOnly(run.dieline, {kHole});
  std::erase_if(run.evidence.kerf.entities,
                [](const vision::EntityKerf& kerf) { return kerf.entity != kHole; });
  return run;
}

TEST(Edges, TheSpotsPathIsMeasuredFromTheMiddleOfItsOwnKerf) {
  // The edges' scan has them where they lie; the beam runs in the middle of the kerf, half a width beside.
  SyntheticRun run;
  const auto sides = checks::kerfSides(run.dieline, Edge::kNesting);
  vision::KerfScan edges = run.evidence.kerf;
  for (vision::EntityKerf& kerf : edges.entities) {
    const int side = sides.side[static_cast<std::size_t>(kerf.entity)];
    for (vision::Caliper& c : kerf.calipers) {
      c.offset_mm = side == 0 ? 0.0 : 0.01 * (kerf.unit + 1) - 0.5 * side * c.width_mm;
    }
  }
  LitFrames lit;
  lit.frames.resize(4);
  lit.frames[0].entity = kBottom;
  lit.frames[1].entity = kBottom;
  lit.frames[1].unit = 1;
  lit.frames[2].left_entity = kHole;  // Has left its line, and is still held against it.
  lit.frames[3].entity = kCreaseLine;
  for (LitFrame& frame : lit.frames) frame.deviation_mm = 0.05;
  checks::measureFromOwnKerf(edges, sides, lit);
  EXPECT_NEAR(lit.frames[0].deviation_mm, 0.04, 1e-9);
  EXPECT_NEAR(lit.frames[1].deviation_mm, 0.03, 1e-9);
  EXPECT_NEAR(lit.frames[2].deviation_mm, 0.04, 1e-9);
  EXPECT_EQ(lit.frames[3].deviation_mm, 0.05) << "a crease has no edge";
}

TEST(Edges, HalfAKerfIsHalfTheMeanWidthOfTheCutsThatHaveAnEdge) {
  SyntheticRun run;
  const auto sides = checks::kerfSides(run.dieline, Edge::kNesting);
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    const bool has_edge = sides.side[static_cast<std::size_t>(kerf.entity)] != 0;
    for (std::size_t i = 0; i < kerf.calipers.size(); ++i)
      kerf.calipers[i].width_mm = has_edge ? (i % 2 == 0 ? 0.19 : 0.23) : 0.5;
  }
  EXPECT_NEAR(checks::halfKerf(run.evidence.kerf, sides), kHalf_mm, 1e-4);
}

TEST(Edges, AHoleAloneIsJudgedAsAHole) {
  const auto inside = holeAlone(kHalf_mm).inspected();
  EXPECT_EQ(checkOf(inside, "edge").verdict, Verdict::kPass) << checkOf(inside, "edge").explanation;
  EXPECT_TRUE(inside.problems.empty());
  const auto outside = holeAlone(-kHalf_mm).inspected();
  EXPECT_EQ(checkOf(outside, "edge").verdict, Verdict::kFail) << checkOf(outside, "edge").explanation;
  EXPECT_NEAR(checkOf(outside, "edge").value, 2.0 * kHalf_mm, 0.01);
}

TEST(Edges, AWiderKerfTakesHalfOfItFromThePiece) {
  const double widening_mm = 0.12;
  const auto result = displaced(kHalf_mm, widening_mm).inspected();
  EXPECT_EQ(checkOf(result, "edge").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "edge").value, 0.5 * widening_mm, 0.006);
}

TEST(Edges, WhatIsNotKnownOfTheWidthIsPartOfTheUncertainty) {
  SyntheticRun run = displaced(kHalf_mm);
  const double without = checkOf(run.inspected(), "edge").u;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) kerf.widening_sigma_mm = 0.02;
  const Check with = checkOf(run.inspected(), "edge");
  // All edges move alike by half of it; U is for two standard deviations.
  EXPECT_NEAR(with.u, std::hypot(without, 0.02), 1e-9);
  EXPECT_EQ(with.guard, with.u);
}

/// Place at which a falling function crosses a level.
template <typename Function>
double crossing(double from_mm, double to_mm, double level, const Function& at) {
  for (int i = 0; i < 60; ++i) {
    const double middle_mm = 0.5 * (from_mm + to_mm);
    (at(middle_mm) > level ? from_mm : to_mm) = middle_mm;
  }
  return 0.5 * (from_mm + to_mm);
}

TEST(SeveredEdge, FollowsFromTheLightOfAGaussianCut) {
  constexpr double kBeam_mm = 0.105;
  for (const double transmission : {0.05, 0.12, 0.30}) {
    for (const double peak : {1.2, 1.6, 3.0}) {  // Over the fluence that severs.
      const auto depthAt = [&](double x_mm) {
        return std::min(1.0, peak * std::exp(-2.0 * x_mm * x_mm / (kBeam_mm * kBeam_mm)));
      };
      const double severed_mm = crossing(0.0, 0.5, 1.0 - 1e-12, depthAt);
      const double light_mm = crossing(0.0, 0.5, 0.5, [&](double x_mm) {
        return (std::pow(transmission, 1.0 - depthAt(x_mm)) - transmission) / (1.0 - transmission);
      });
      SyntheticRun run;
      for (vision::EntityKerf& kerf : run.evidence.kerf.entities)
        for (vision::Caliper& c : kerf.calipers) c.width_mm = 2.0 * light_mm;
      const auto sides = checks::kerfSides(run.dieline, Edge::kNesting);
      const auto scan = checks::severedScan(run.evidence.kerf, sides, kBeam_mm, transmission);
      for (const vision::EntityKerf& kerf : scan.entities) {
        const bool has_edge = sides.side[static_cast<std::size_t>(kerf.entity)] != 0;
        EXPECT_NEAR(kerf.calipers[9].width_mm, 2.0 * (has_edge ? severed_mm : light_mm), 1e-6)
            << transmission << " " << peak;
      }
    }
  }
}

TEST(SeveredEdge, IsWithinItsUncertaintyForAnotherBeamBoardAndLaw) {
  // What the bench is told: 0.105 mm and 12 %, depth in proportion to fluence. What is: up to two standard
  // uncertainties of one of these.
  struct World {
    double beam_mm, transmission, law;
  };
  double largest_share = 0.0;  // Share of the stated uncertainty that an error takes up.
  for (const World& world :
       {World{0.105 * 1.09, 0.12, 1.0}, World{0.105 * 0.91, 0.12, 1.0}, World{0.105, 0.12 * 1.1, 1.0},
        World{0.105, 0.12, 0.8}, World{0.105, 0.12, 1.25}}) {
    const auto depthAt = [&](double x_mm) {
      const double share = 1.6 * std::exp(-2.0 * x_mm * x_mm / (world.beam_mm * world.beam_mm));
      return std::min(1.0, std::pow(share, world.law));
    };
    const double severed_mm = crossing(0.0, 0.5, 1.0 - 1e-12, depthAt);
    const double light_mm = crossing(0.0, 0.5, 0.5, [&](double x_mm) {
      return (std::pow(world.transmission, 1.0 - depthAt(x_mm)) - world.transmission) /
             (1.0 - world.transmission);
    });
    SyntheticRun run;
    vision::EntityKerf& kerf = run.kerf(0, kHole);
    for (vision::Caliper& c : kerf.calipers) c.width_mm = 2.0 * light_mm;
    kerf.widening_sigma_mm = 0.0;
    const auto scan =
        checks::severedScan(run.evidence.kerf, checks::kerfSides(run.dieline, Edge::kNesting), 0.105, 0.12);
    const auto& told = *std::ranges::find_if(
        scan.entities, [](const vision::EntityKerf& k) { return k.unit == 0 && k.entity == kHole; });
    EXPECT_NEAR(0.5 * told.calipers[9].width_mm, severed_mm, told.widening_sigma_mm)  // Half a width, k = 2.
        << world.beam_mm << " " << world.transmission << " " << world.law;
    largest_share = std::max(largest_share,
                             std::abs(0.5 * told.calipers[9].width_mm - severed_mm) / told.widening_sigma_mm);
  }
  EXPECT_GT(largest_share, 0.5) << "stated too large to prove anything";
}

TEST(Edges, IsJudgedWhereTheBoardIsSevered) {
  SyntheticRun run;
  run.limits.edge = Edge::kNesting;
  run.limits.path_mm = 0.12;
  const double by_light_mm = checkOf(run.inspected(), "edge").value;
  run.evidence.beam_radius_mm = 0.15;
  // 0.105² - 0.15² / 2 ln(1 / 0.727) = 0.0862²: the kerf is on the line, its edge half of its width off.
  const Check edge = checkOf(run.inspected(), "edge");
  EXPECT_NEAR(by_light_mm, 0.105, 0.002);
  EXPECT_NEAR(edge.value, 0.0862, 0.002);
  EXPECT_GT(edge.u, 0.004);
}

TEST(Edges, WithoutABeamsRadiusItSaysThatTheEdgeIsThatOfTheLight) {
  const auto explained = [](double severed_mm) {
    return checks::edgeCheck({}, {}, severed_mm, kHalf_mm).explanation;
  };
  EXPECT_NE(explained(kHalf_mm).find("by the light, as nothing is known of the beam"), std::string::npos);
  EXPECT_NE(explained(0.9 * kHalf_mm).find("0.1050 mm where half of the light comes through"),
            std::string::npos);
}

TEST(Edges, AKerfWithoutAWidthIsInvalid) {
  SyntheticRun run = displaced(kHalf_mm);
  run.kerf(0, kTop).calipers[40].width_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

/// Deviation of a run with one right-angled corner whose centre line is rounded by `rounding_mm`; its legs
/// lie `inwards_mm` farther in the piece.
double cornerDeviation(double turn_rad, Edge edge, double rounding_mm, double overshoot_mm = 0.0,
                       double inwards_mm = 0.0) {
  SyntheticRun run = displaced(edge == Edge::kInside ? -kHalf_mm : kHalf_mm);
  run.limits.edge = edge;
  for (const int leg : {kBottom, kRight})
    for (vision::Caliper& c : run.kerf(0, leg).calipers) c.offset_mm += inwards_mm;
  vision::CornerKerf corner;
  corner.entity_in = turn_rad > 0.0 ? kBottom : kRight;
  corner.entity_out = turn_rad > 0.0 ? kRight : kBottom;
  corner.p_S_mm = {60, 0};
  corner.turn_rad = turn_rad;
  corner.found = true;
  corner.rounding_mm = rounding_mm;
  corner.overshoot_mm = overshoot_mm;
  corner.deviation_mm = 9.0;  // The deviation of the centre line must not count.
  corner.rounding_sigma_mm = corner.overshoot_sigma_mm = corner.deviation_sigma_mm = 0.0005;
  run.evidence.kerf.corners = {corner};
  return checkOf(run.inspected(), "joints").value;
}

TEST(Edges, CornersFollowFromLegsAndRounding) {
  const double by_kerf_mm = kHalf_mm * (std::numbers::sqrt2 - 1.0);
  for (const double turn : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi}) {
    // A beam outside of the corner goes round it: at the kerf's own radius the piece stays sharp, with a
    // wider one it does not.
    EXPECT_NEAR(cornerDeviation(turn, Edge::kOutside, 0.0), 0.0, 0.003);
    EXPECT_NEAR(cornerDeviation(turn, Edge::kOutside, by_kerf_mm), 0.0, 0.003);
    EXPECT_NEAR(cornerDeviation(turn, Edge::kOutside, by_kerf_mm + 0.03), 0.03, 0.003);
    EXPECT_NEAR(cornerDeviation(turn, Edge::kOutside, 0.0, 0.1), 0.0, 0.003);
    // A beam inside cannot cut what lies in the corner, and a leg that runs over cuts into the piece.
    EXPECT_NEAR(cornerDeviation(turn, Edge::kInside, 0.0), by_kerf_mm, 0.003);
    EXPECT_NEAR(cornerDeviation(turn, Edge::kInside, 0.02), by_kerf_mm + 0.02, 0.003);
    EXPECT_NEAR(cornerDeviation(turn, Edge::kInside, 0.0, 0.1), 0.1, 0.003);
  }
}

TEST(Edges, ARoundedCornerDeviatesByItsLegsAsWell) {
  const double rounded_mm = kHalf_mm * (std::numbers::sqrt2 - 1.0) + 0.02;
  for (const double turn : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi}) {
    // Both legs move the corner along its bisector, which is the way that rounding moves it.
    for (const double inwards_mm : {-0.01, 0.01}) {
      EXPECT_NEAR(cornerDeviation(turn, Edge::kInside, 0.02, 0.0, inwards_mm),
                  rounded_mm + std::numbers::sqrt2 * inwards_mm, 0.003)
          << inwards_mm;
    }
  }
}

TEST(Edges, ACornerDeviatesByTheLegThatLiesBeside) {
  constexpr double kBeside_mm = 0.04;
  SyntheticRun run = displaced(kHalf_mm);
  vision::CornerKerf corner{.unit = 0, .entity_in = kBottom, .entity_out = kRight, .p_S_mm = {60, 0}};
  corner.turn_rad = 0.5 * std::numbers::pi;
  corner.found = true;
  corner.rounding_sigma_mm = corner.overshoot_sigma_mm = corner.deviation_sigma_mm = 0.0005;
  run.evidence.kerf.corners = {corner};
  const auto sides = checks::kerfSides(run.dieline, Edge::kNesting);
  for (const int leg : {kBottom, kRight}) {
    vision::KerfScan scan = run.evidence.kerf;
    for (vision::EntityKerf& kerf : scan.entities) {
      if (kerf.unit != 0 || kerf.entity != leg) continue;
      for (vision::Caliper& c : kerf.calipers)
        c.offset_mm += sides.side[static_cast<std::size_t>(leg)] * kBeside_mm;
    }
    const vision::KerfScan edges = checks::edgeScan(scan, run.dieline, sides);
    EXPECT_NEAR(edges.corners.at(0).deviation_mm, kBeside_mm, 0.003) << leg;
  }
}

constexpr double kBesideCorner_mm = 0.04;

/// Deviation of a corner's edge where the kerf of one leg lies so far beside, and all others where they
/// should.
double edgeCornerBeside(const dieline::Dieline& dieline, vision::CornerKerf corner, int leg) {
  const auto sides = checks::kerfSides(dieline, Edge::kOutside);
  constexpr double kWidth_mm = 0.2;
  vision::KerfScan scan;
  for (const dieline::Entity& entity : dieline.entities) {
    vision::EntityKerf& kerf = scan.entities.emplace_back(vision::EntityKerf{0, entity.id, {}});
    const double beside_mm = entity.id == leg ? kBesideCorner_mm : 0.0;
    for (int i = 0; i < 20; ++i) {
      vision::Caliper& c = kerf.calipers.emplace_back();
      c.station_mm = 0.25 * i;
      c.found = true;
      c.width_mm = kWidth_mm;
      c.offset_mm = sides.side[static_cast<std::size_t>(entity.id)] * (0.5 * kWidth_mm + beside_mm);
    }
  }
  corner.turn_rad = 0.5 * std::numbers::pi;
  corner.found = true;
  scan.corners = {corner};
  const vision::CornerKerf read = checks::edgeScan(scan, dieline, sides).corners.at(0);
  EXPECT_TRUE(read.found);
  return read.deviation_mm;
}

TEST(Edges, ALegThatIsAnArcLeavesTheCornerAlongItsOwnStart) {
  // A line to the right, a quarter of a circle up from its end, and a line back.
  const dieline::Dieline dieline = drawingOf({dieline::LineCurve{{0.0, 0.0}, {10.0, 0.0}},
                                              dieline::ArcCurve{{5.0, 0.0}, 5.0, 0.0, 0.5 * std::numbers::pi},
                                              dieline::LineCurve{{5.0, 5.0}, {0.0, 0.0}}});
  EXPECT_NEAR(
      edgeCornerBeside(dieline, {.unit = 0, .entity_in = 0, .entity_out = 1, .p_S_mm = {10.0, 0.0}}, 0),
      kBesideCorner_mm, 1e-9);
}

TEST(Edges, ALegThatIsAnArcComesToTheCornerAlongItsOwnEnd) {
  // A quarter of a circle up, a line down from its end, and a line back to its start.
  const dieline::Dieline dieline =
      drawingOf({dieline::ArcCurve{{5.0, 0.0}, 5.0, 0.0, 0.5 * std::numbers::pi},
                 dieline::LineCurve{{5.0, 5.0}, {5.0, 0.0}}, dieline::LineCurve{{5.0, 0.0}, {10.0, 0.0}}});
  EXPECT_NEAR(
      edgeCornerBeside(dieline, {.unit = 0, .entity_in = 0, .entity_out = 1, .p_S_mm = {5.0, 5.0}}, 1),
      kBesideCorner_mm, 1e-9);
}

TEST(Edges, ALineEndsBeforeACornerThatTheBeamCutsFromInside) {
  SyntheticRun run = displaced(kHalf_mm);
  vision::CornerKerf corner{.unit = 0, .entity_in = kBottom, .entity_out = kRight, .p_S_mm = {60, 0}};
  corner.turn_rad = 0.5 * std::numbers::pi;
  run.evidence.kerf.corners = {corner};
  const auto inside = checks::kerfSides(run.dieline, Edge::kInside);
  const auto outside = checks::kerfSides(run.dieline, Edge::kOutside);
  const auto shortened = [&](const checks::EdgeSides& sides, int entity, bool at_start) {
    return checks::shortenedBy(run.evidence.kerf, run.dieline, sides, kHalf_mm, run.kerf(0, entity),
                               at_start);
  };
  EXPECT_NEAR(shortened(inside, kBottom, false), kHalf_mm, 1e-9);
  EXPECT_NEAR(shortened(inside, kRight, true), kHalf_mm, 1e-9);
  EXPECT_EQ(shortened(inside, kBottom, true), 0.0);
  EXPECT_EQ(shortened(inside, kTop, true), 0.0);
  EXPECT_EQ(shortened(outside, kBottom, false), 0.0);

  // A side alone: both of its corners are with lines that are not selected.
  run.evidence.kerf.corners.clear();
  EXPECT_EQ(shortened(inside, kBottom, false), 0.0);
  const dieline::Dieline whole = run.dieline;
  for (const int alone : {kBottom, kRight}) {
    run.dieline = whole;
    keepOnly(run.dieline, {alone});
    for (const bool at_start : {false, true}) {
      EXPECT_NEAR(shortened(inside, alone, at_start), kHalf_mm, 1e-9) << alone;
      EXPECT_EQ(shortened(outside, alone, at_start), 0.0) << alone;
    }
  }
}

}  // namespace
}  // namespace kerfbench::inspect

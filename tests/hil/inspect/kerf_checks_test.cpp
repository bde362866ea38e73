// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "twin/base/constants.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(PathCheck, ProvesADeviationAndSaysWhere) {
  SyntheticRun run;
  run.kerf(1, kRight).calipers[80].offset_mm = -0.08;
  const auto result = run.inspected();
  const Check& path = checkOf(result, "path");
  EXPECT_EQ(path.verdict, Verdict::kFail);
  EXPECT_EQ(path.subject, "unit 1, E1");
  EXPECT_NE(path.explanation.find("to the right of the line at x 60.00, y 20.00 mm"), std::string::npos)
      << path.explanation;
  EXPECT_NEAR(path.value, 0.08, 0.005);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  for (const EntityResult& e : result.entities) {
    if (e.unit == 1 && e.entity == kRight) {
      EXPECT_NEAR(e.worst_mm, -0.08, 0.005) << "right of the line is negative";
    }
  }
}

TEST(PathCheck, AtTheLimitNothingIsProven) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[100].offset_mm = 0.051;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kNotProven);
  EXPECT_EQ(run.inspected().verdict, Verdict::kNotProven);
}

TEST(PathCheck, LeavesOutJoints) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[0].offset_mm = 0.3;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kPass);
}

TEST(PathCheck, WithoutStatedUncertaintyIsInvalid) {
  SyntheticRun run;
  run.evidence.kerf_calibration.reset();
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kInvalid);
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(Places, AreNeverShownAsMinusZero) {
  EXPECT_EQ(checks::placeOf({-0.001, -0.0049}), "x 0.00, y 0.00 mm");
  EXPECT_EQ(checks::placeOf({-0.006, 12.345}), "x -0.01, y 12.35 mm");
}

/// The cuts of the order, one of them changed.
std::vector<std::pair<double, double>> cutsWith(std::size_t index, double from_mm, double to_mm) {
  auto cuts = SyntheticRun::cutsOf(3.0, 1.0);
  cuts.at(index) = {from_mm, to_mm};
  return cuts;
}

Check perforationOf(const SyntheticRun& run) { return *checks::perforationCheck(run.evidence, run.limits); }

Check perforated(const std::vector<std::pair<double, double>>& cuts_mm,
                 const Tolerances::Perforation& order = {}) {
  SyntheticRun run;
  run.limits.perforation = order;
  run.perforate(1, cuts_mm);
  return perforationOf(run);
}

TEST(PerforationCheck, PassesWhatWasOrdered) {
  const Check check = checkOf(SyntheticRun().inspected(), "perforation");
  EXPECT_EQ(check.verdict, Verdict::kPass);
  EXPECT_LT(check.value, 0.002);
  // What lies beyond the first and the last cut no caliper shows.
  EXPECT_THAT(check.explanation, HasSubstr("Of 14 cuts and 16 bridges"));
}

TEST(PerforationCheck, FailsAnotherPatternOfTheSameShare) {
  const Tolerances::Perforation order{.cut_mm = 6.0, .bridge_mm = 2.0};
  EXPECT_EQ(perforated(SyntheticRun::cutsOf(3.0, 1.0), order).verdict, Verdict::kFail);
  EXPECT_EQ(perforated(SyntheticRun::cutsOf(2.0, 2.0)).verdict, Verdict::kFail);
}

TEST(PerforationCheck, StretchesTheOrderToAWholeNumberOfCuts) {
  const Tolerances::Perforation order{.cut_mm = 6.0, .bridge_mm = 2.0};
  const double stretch = 35.0 / (5.0 * 8.0 - 2.0);  // Five cuts.
  SyntheticRun run;
  run.limits.perforation = order;
  for (const int unit : {0, 1}) run.perforate(unit, SyntheticRun::cutsOf(6.0 * stretch, 2.0 * stretch));
  const Check check = perforationOf(run);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
  EXPECT_LT(check.value, 0.002);
}

TEST(PerforationCheck, MeasuresAShortBridgeAndALongCut) {
  // The fourth cut is ordered from 12 to 15 mm.
  for (const double longer_mm : {0.3, 0.6}) {
    const Check check = perforated(cutsWith(3, 12.0, 15.0 + longer_mm));
    EXPECT_EQ(check.verdict, Verdict::kFail);
    EXPECT_NEAR(check.value, longer_mm, 0.002);
    EXPECT_EQ(check.subject, "unit 1, E6");
  }
  EXPECT_EQ(perforated(cutsWith(3, 12.0, 15.1)).verdict, Verdict::kPass);
  EXPECT_EQ(perforated(cutsWith(3, 12.0, 14.8)).verdict, Verdict::kFail);
}

TEST(PerforationCheck, NearTheLimitProvesNothing) {
  EXPECT_EQ(perforated(cutsWith(3, 12.0, 15.165)).verdict, Verdict::kNotProven);
}

TEST(PerforationCheck, FindsACutThatIsMissingAndABridgeTooMany) {
  auto one_less = SyntheticRun::cutsOf(3.0, 1.0);
  one_less.erase(one_less.begin() + 4);
  EXPECT_NEAR(perforated(one_less).value, 4.0, 0.01);
  auto one_more = SyntheticRun::cutsOf(3.0, 1.0);
  one_more[4].second = one_more[4].first + 1.2;
  one_more.emplace_back(one_more[4].second + 0.5, one_more[4].first + 3.0);
  EXPECT_EQ(perforated(one_more).verdict, Verdict::kFail);
}

TEST(PerforationCheck, FindsAPatternThatIsShiftedAndTellsWhichWay) {
  const auto shifted = [](double by_mm) {
    auto cuts = SyntheticRun::cutsOf(3.0, 1.0);
    for (auto& [from_mm, to_mm] : cuts) {
      from_mm += by_mm;
      to_mm += by_mm;
    }
    const Check check = perforated(cuts);
    EXPECT_EQ(check.verdict, Verdict::kFail);
    EXPECT_NEAR(check.value, 0.4, 0.002);
    return check.explanation;
  };
  const std::string one = shifted(0.4);
  const std::string other = shifted(-0.4);
  EXPECT_NE(one.find("0.40 mm too early") == std::string::npos,
            other.find("0.40 mm too early") == std::string::npos)
      << one << other;
  EXPECT_NE(one.find("0.40 mm too late") == std::string::npos,
            other.find("0.40 mm too late") == std::string::npos)
      << one << other;
}

TEST(PerforationCheck, OfTwoUnitsThatAreEquallyOffTheFirstIsNamed) {
  SyntheticRun run;
  for (const int unit : {0, 1}) run.perforate(unit, cutsWith(3, 12.0, 15.6));
  EXPECT_EQ(perforationOf(run).subject, "unit 0, E6");
}

TEST(PerforationCheck, WhereLinesBranchAPatternNeedNotEndWithACut) {
  // At its end two more perforations go on from the line, so that nobody orders what lies there.
  SyntheticRun run;
  run.dieline.entities[kNote] = {kNote, dieline::LineCurve{{45, 37}, {45, 50}},
                                 dieline::Process::kPerforation, "OTHER", "line 74: LINE"};
  run.dieline.entities.push_back({kNote + 1, dieline::ArcCurve{{55, 37}, 10, kPi, -0.5 * kPi},
                                  dieline::Process::kPerforation, "OTHER", "line 84: ARC"});
  const double stretch = SyntheticRun::kPerforation_mm / 36.0;
  std::vector<std::pair<double, double>> cuts;
  for (int k = -1; k < 9; ++k)
    cuts.emplace_back(4.0 * stretch * k + 2.0, 4.0 * stretch * k + 2.0 + 3.0 * stretch);
  for (const int unit : {0, 1}) run.perforate(unit, cuts);
  const Check check = perforationOf(run);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
}

TEST(PerforationCheck, WithoutBridgesAndWithoutCutsFails) {
  EXPECT_EQ(perforated({{0.0, 35.0}}).verdict, Verdict::kFail);
  EXPECT_EQ(perforated({}).verdict, Verdict::kFail);
}

TEST(PerforationCheck, CountsFromTheDrawnStartAndTellsEarlyFromLateThatWay) {
  // Its neighbours give way, so that no length is as far off as the place where it begins.
  auto late = SyntheticRun::cutsOf(3.0, 1.0);
  late[2].second = 11.3;
  late[3] = {12.5, 15.3};
  EXPECT_THAT(perforated(late).explanation,
              HasSubstr("unit 1, E6: a cut begins 0.50 mm too late, 12.5 mm from its start"));
  auto early = SyntheticRun::cutsOf(3.0, 1.0);
  early[3] = {11.7, 14.5};
  early[4].first = 15.7;
  EXPECT_THAT(perforated(early).explanation,
              HasSubstr("unit 1, E6: a cut ends 0.50 mm too early, 14.5 mm from its start"));
  EXPECT_THAT(perforated(cutsWith(3, 11.7, 15.3)).explanation,
              HasSubstr("a cut is 3.60 mm long for 3.00, 11.7 mm from its start"));
}

/// Parts the perforated line at 13 mm, in the middle of a cut, the second piece drawn backward.
void partInTwo(SyntheticRun& run) {
  run.dieline.entities[kPerforationLine].curve = dieline::LineCurve{{45, 2}, {45, 15}};
  run.dieline.entities[kNote] = {kNote, dieline::LineCurve{{45, 37}, {45, 15}},
                                 dieline::Process::kPerforation, "OTHER", "line 74: LINE"};
  for (int unit = 0; unit < 2; ++unit) {
    vision::EntityKerf& all = run.kerf(unit, kPerforationLine);
    vision::EntityKerf rest{unit, kNote, {}};
    const auto beyond = [](const auto& reading) { return reading.station_mm > 13.0; };
    std::ranges::copy_if(all.calipers, std::back_inserter(rest.calipers), beyond);
    std::ranges::copy_if(all.light, std::back_inserter(rest.light), beyond);
    std::erase_if(all.calipers, beyond);
    std::erase_if(all.light, beyond);
    std::ranges::reverse(rest.calipers);
    std::ranges::reverse(rest.light);
    for (vision::LightReading& r : rest.light) r.station_mm = 35.0 - r.station_mm;
    for (vision::Caliper& c : rest.calipers) {
      c.station_mm = 35.0 - c.station_mm;
      c.u = c.station_mm / 22.0;
    }
    for (vision::Caliper& c : all.calipers) c.u = c.station_mm / 13.0;
    run.evidence.kerf.entities.push_back(rest);
  }
}

TEST(PerforationCheck, LinesThatMeetEndToEndHaveOnePattern) {
  SyntheticRun run;
  partInTwo(run);
  const Check check = perforationOf(run);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
  EXPECT_LT(check.value, 0.002);
}

TEST(PerforationCheck, OfLinesThatMeetTheOneWithTheFaultIsNamedAsItIsDrawn) {
  // The eighth cut, ordered from 28 to 31 mm, ends early: as the second piece is drawn, it begins late, 4.5
  // instead of 4 mm from its start.
  auto cuts = cutsWith(7, 27.7, 30.5);
  cuts[8].first = 31.7;
  SyntheticRun run;
  run.perforate(1, cuts);
  partInTwo(run);
  const Check check = perforationOf(run);
  EXPECT_EQ(check.subject, "unit 1, E7");
  EXPECT_THAT(check.explanation,
              HasSubstr("unit 1, E7: a cut begins 0.50 mm too late, 4.5 mm from its start"));
  SyntheticRun other;
  other.perforate(1, cutsWith(7, 27.7, 31.3));
  partInTwo(other);
  EXPECT_THAT(perforationOf(other).explanation,
              HasSubstr("unit 1, E7: a cut is 3.60 mm long for 3.00, 3.7 mm from its start"));
  // The fourth cut lies across the place where they meet, at the end of the first as that is drawn.
  SyntheticRun across;
  across.perforate(1, cutsWith(3, 11.7, 15.3));
  partInTwo(across);
  EXPECT_THAT(perforationOf(across).explanation,
              HasSubstr("unit 1, E6: a cut is 3.60 mm long for 3.00, 11.7 mm from its start"));
}

TEST(PerforationCheck, AClosedLineMayHaveABridgeAtItsSeam) {
  // Round 35 mm nine cuts fit, a little shorter than ordered; one of them ends so near before the seam that
  // only the last two readings show it.
  const double stretch = SyntheticRun::kPerforation_mm / 36.0;
  std::vector<std::pair<double, double>> cuts;
  for (int k = -9; k <= 9; ++k) {
    const double end_mm = SyntheticRun::kPerforation_mm - 0.05 + 4.0 * stretch * k;
    cuts.emplace_back(end_mm - 3.0 * stretch, end_mm);
  }
  SyntheticRun run;
  run.dieline.entities[kPerforationLine].curve =
      dieline::ArcCurve{{45, 20}, SyntheticRun::kPerforation_mm / (2.0 * kPi), 0.0, 2.0 * kPi};
  for (const int unit : {0, 1}) run.perforate(unit, cuts);
  const Check check = perforationOf(run);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
  EXPECT_LT(check.value, 0.01) << check.explanation;
  EXPECT_THAT(check.explanation, HasSubstr("Of 18 cuts and 18 bridges"));
}

TEST(PerforationCheck, WithoutAnOrderIsNotJudged) {
  SyntheticRun run;
  run.limits.perforation.cut_mm = 0.0;
  EXPECT_TRUE(unjudgedOf(run.inspected(), "perforation").applies);
}

/// The width that is farthest from 0.24 mm, as measured.
double worstWidth(const SyntheticRun& run) {
  double worst_mm = 0.24;
  for (const EntityResult& e : run.inspected().entities) {
    const bool is_cut =
        run.dieline.entities[static_cast<std::size_t>(e.entity)].process == dieline::Process::kCut;
    if (is_cut && std::abs(e.width_mm - 0.24) > std::abs(worst_mm - 0.24)) worst_mm = e.width_mm;
  }
  return worst_mm;
}

TEST(OrderedWidth, IsHeldAgainstTheOrderAndNotAgainstTheOthers) {
  SyntheticRun run;
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_width").applies);
  run.limits.ordered_width = {.nominal_mm = 0.21, .limit_mm = 0.02};
  EXPECT_EQ(checkOf(run.inspected(), "ordered_width").verdict, Verdict::kPass);
  for (const double nominal_mm : {0.18, 0.24}) {
    run.limits.ordered_width.nominal_mm = nominal_mm;
    const InspectionResult result = run.inspected();
    EXPECT_EQ(checkOf(result, "ordered_width").verdict, Verdict::kFail) << nominal_mm;
    EXPECT_EQ(checkOf(result, "kerf_width").verdict, Verdict::kPass);
    EXPECT_EQ(result.verdict, Verdict::kFail);
  }
  run.limits.ordered_width.limit_mm = std::abs(worstWidth(run) - 0.24);
  run.limits.ordered_width.nominal_mm = 0.24;
  EXPECT_EQ(checkOf(run.inspected(), "ordered_width").verdict, Verdict::kNotProven);
}

/// Light through a groove's middle as a lens shows it, by a sum over its profile.
double brightnessOfGroove(double depth, double beam_mm, double lens_mm, double transmission) {
  double sum = 0.0;
  double weight = 0.0;
  for (double x_mm = -5.0 * lens_mm; x_mm <= 5.0 * lens_mm; x_mm += 0.01 * lens_mm) {
    const double w = std::exp(-0.5 * x_mm * x_mm / (lens_mm * lens_mm));
    const double at = std::min(1.0, depth * std::exp(-2.0 * x_mm * x_mm / (beam_mm * beam_mm)));
    sum += w * std::pow(transmission, 1.0 - at);
    weight += w;
  }
  return (sum / weight - transmission) / (1.0 - transmission);
}

/// A carton whose crease is `depth` deep, as the bench sees it.
SyntheticRun creased(double depth, double beam_mm = 0.105, double transmission = 0.12) {
  SyntheticRun run;
  run.evidence.beam_radius_mm = 0.105;
  const double brightness = brightnessOfGroove(depth, beam_mm, 0.02, transmission);
  for (int unit = 0; unit < 2; ++unit) {
    vision::EntityKerf& kerf = run.kerf(unit, kCreaseLine);
    kerf.middle_sigma_mm = 0.02;
    for (vision::Caliper& c : kerf.calipers) c.brightness = brightness;
  }
  return run;
}

TEST(OrderedDepth, IsHeldAgainstBothBounds) {
  SyntheticRun run = creased(0.6);
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_depth").applies);
  for (const auto& [least, most, verdict] :
       {std::tuple{0.50, 0.70, Verdict::kPass}, std::tuple{0.65, 0.90, Verdict::kFail},
        std::tuple{0.40, 0.55, Verdict::kFail}, std::tuple{0.58, 0.75, Verdict::kNotProven},
        std::tuple{0.45, 0.62, Verdict::kNotProven}}) {
    run.limits.crease_depth = {least, most};
    const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
    EXPECT_EQ(check.verdict, verdict) << check.explanation;
    EXPECT_NEAR(check.value, std::min(0.6 - least, most - 0.6), 0.002);
  }
  run.evidence.beam_radius_mm = 0.0;
  EXPECT_TRUE(unjudgedOf(run.inspected(), "ordered_depth").applies);
  run.limits.crease_depth = {};
  run.limits.half_cut_depth = {0.1, 0.2};  // The carton has no half-cut.
  EXPECT_FALSE(unjudgedOf(run.inspected(), "ordered_depth").applies);
}

TEST(OrderedDepth, WhatIsLeftOverAtAnEndIsNoStretchOfItsOwn) {
  // One caliper tells depth to 1 % of itself only, and the light of one may lie. Here it is the last that
  // counts, behind the last whole millimetre.
  SyntheticRun run = creased(0.6);
  const double length_mm = dieline::lengthOf(run.dieline.entities[kCreaseLine].curve);
  vision::Caliper& last =
      *std::ranges::find_if(run.kerf(0, kCreaseLine).calipers,
                            [&](const vision::Caliper& c) { return c.station_mm > length_mm - 0.6; });
  last.brightness = brightnessOfGroove(0.75, 0.105, 0.02, 0.12);
  run.limits.crease_depth = {0.5, 0.7};
  const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
}

TEST(OrderedDepth, IsWithinItsUncertaintyForAnotherBeamAndAnotherBoard) {
  for (const double depth : {0.3, 0.6, 0.8}) {
    for (const auto& [beam, transmission] :
         {std::pair{1.1, 1.0}, std::pair{0.9, 1.0}, std::pair{1.0, 1.1}, std::pair{1.0, 0.9}}) {
      SyntheticRun run = creased(depth, 0.105 * beam, 0.12 * transmission);
      // The bench reads against the grey of whole board as it is, and takes 12 % for its transmission.
      run.limits.crease_depth = {0.01, 0.99};
      const Check check = *checks::orderedDepthCheck(run.evidence, run.limits);
      EXPECT_NEAR(check.value, std::min(depth - 0.01, 0.99 - depth), 1.05 * check.u + 0.002)
          << depth << " " << beam << " " << transmission;
    }
  }
}

TEST(KerfWidthCheck, FindsTheLineThatIsWider) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.07;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "kerf_width").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "kerf_width").subject, "unit 1, E2");
}

TEST(KerfWidthCheck, NearTheLimitLooseWidthsProveNothing) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.048;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kPass);
  // The mean of 240 stations is sixteen times better than one: 3 um. A smaller deviation is hardly proven.
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_sigma_mm = 0.05;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kNotProven);
}

TEST(StrayCheck, OneOfUnknownSizeIsInvalid) {
  SyntheticRun run;
  for (const double extent_mm : {0.2, kNan, 0.3})
    run.evidence.kerf.strays.push_back({0, {33, 12}, extent_mm});
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(StrayCheck, AScanTellsAllThatMayBreakTheLimit) {
  constexpr double kPitch_mm = 0.04;
  Tolerances limits;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.42, 1e-12) << "one of 0.49 mm is not proven to keep 0.5";
  limits.stray_mm = 0.2;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.12, 1e-12);
  limits.stray_mm = 5.0;
  EXPECT_NEAR(limits.leastStray_mm(kPitch_mm), 0.42, 1e-12) << "smaller ones are dust whatever the limit";

  SyntheticRun run;
  const double pitch_mm = run.evidence.kerf_calibration->pitchMm();
  run.evidence.kerf.strays.push_back({0, {33, 12}, 0.5 - 0.5 * pitch_mm});
  EXPECT_EQ(checkOf(run.inspected(), "stray").verdict, Verdict::kNotProven);
  run.limits.stray_mm = 0.2;
  EXPECT_EQ(checkOf(run.inspected(), "stray").verdict, Verdict::kFail);
}

TEST(StrayCheck, FailsOnWhatIsBurntBeside) {
  SyntheticRun run;
  run.evidence.kerf.strays.push_back({0, {10, 3}, 0.3});
  run.evidence.kerf.strays.push_back({1, {33, 12}, 4.2});
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stray").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(result, "stray").explanation.find("4.20 mm long, at x 33.00, y 12.00 mm of unit 1"),
            std::string::npos);
}

TEST(LaserTimingCheck, SaysThatAllEndsAreBurntWhereTheyAre) {
  // Five lines of each of two units end; the perforation and the circle do not.
  EXPECT_EQ(checkOf(SyntheticRun().inspected(), "laser_timing").explanation,
            "The kerf reaches all 20 line ends.");
}

TEST(LaserTimingCheck, FindsAStartThatIsNotBurnt) {
  SyntheticRun run;
  // A laser that is 2 ms late leaves about 0.28 mm without enough power at each start.
  unburn(run.kerf(0, kBottom).calipers[0]);
  run.kerf(0, kBottom).calipers[1].brightness = 0.2;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "laser_timing").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "laser_timing").value, 0.34, 0.02);
  EXPECT_NE(checkOf(result, "laser_timing").explanation.find("At the start of unit 0, E0"),
            std::string::npos);
}

TEST(LaserTimingCheck, AShortGapIsNoMatterOfCoverage) {
  SyntheticRun run;
  run.limits.end_gap_mm = 0.3;
  for (vision::Caliper* c :
       {&run.kerf(0, kCreaseLine).calipers.front(), &run.kerf(0, kCreaseLine).calipers.back()})
    unburn(*c);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").value, 0.0);
}

TEST(LaserTimingCheck, SeesTheGapBehindANeighboursKerf) {
  SyntheticRun run;
  // The end point itself is bright with the kerf of the adjoining line.
  auto& calipers = run.kerf(0, kTop).calipers;
  calipers[calipers.size() - 2].brightness = 0.0;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(run.inspected(), "laser_timing").explanation.find("At the end of"), std::string::npos);
}

Finding laserTimingOf(const SyntheticRun& run) {
  std::vector<EntityResult> entities;
  for (const vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    EntityResult& entity = entities.emplace_back();
    entity.unit = kerf.unit;
    entity.entity = kerf.entity;
    entity.coverage = checks::coverageOf(run.evidence, kerf, run.limits);
  }
  return checks::laserTimingCheck(run.evidence, run.limits, entities, nullptr);
}

TEST(LaserTimingCheck, ALineThatIsMostlyThereHasEnds) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kBottom).calipers;
  for (std::size_t i = 80; i < 176; ++i) unburn(calipers[i]);  // 40 %
  unburn(calipers[0]);
  calipers[1].brightness = 0.2;
  const Finding check = laserTimingOf(run);
  EXPECT_EQ(check->verdict, Verdict::kFail);
  EXPECT_EQ(check->subject, "unit 0, E0");
}

TEST(LaserTimingCheck, DoesNotApplyWhereNoLineEnds) {
  SyntheticRun run;
  for (dieline::Entity& entity : run.dieline.entities) {
    if (entity.id <= kLeft || entity.id == kCreaseLine) entity.process = dieline::Process::kPerforation;
  }
  const Finding check = laserTimingOf(run);
  ASSERT_FALSE(check);
  EXPECT_FALSE(check.why().applies);
}

TEST(LaserTimingCheck, AHalfLitEndIsNoGap) {
  SyntheticRun run;
  // At the tip of a slit the end point gets half of the line's energy.
  run.kerf(0, kBottom).calipers[0].brightness = 0.4;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kPass);
}

}  // namespace
}  // namespace kerfbench::inspect

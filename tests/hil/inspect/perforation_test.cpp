// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string>
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
  // The neighbours of the fault give way, so that no length is as far off as the place where it begins.
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

TEST(PerforationCheck, ALineAsLongAsOneCutAndOneBridgeHasOneOfEach) {
  SyntheticRun run;
  run.limits.perforation = {.cut_mm = 20.0, .bridge_mm = 15.0};
  run.dieline.entities[kPerforationLine].curve =
      dieline::ArcCurve{{45, 20}, SyntheticRun::kPerforation_mm / (2.0 * kPi), 0.0, 2.0 * kPi};
  for (const int unit : {0, 1}) run.perforate(unit, {{5.0, 25.0}});
  const Check check = perforationOf(run);
  EXPECT_EQ(check.verdict, Verdict::kPass) << check.explanation;
  EXPECT_LT(check.value, 0.01) << check.explanation;
}

TEST(PerforationCheck, WithoutAnOrderIsNotJudged) {
  SyntheticRun run;
  run.limits.perforation.cut_mm = 0.0;
  EXPECT_TRUE(unjudgedOf(run.inspected(), "perforation").applies);
}

}  // namespace
}  // namespace kerfbench::inspect

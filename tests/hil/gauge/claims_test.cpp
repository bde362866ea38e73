// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "hil/gauge/gauge.h"
#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::pair<std::string, Reading>> readings(std::size_t count, double true_sigma, double U) {
  const CounterRandom random(3, 1);
  std::vector<std::pair<std::string, Reading>> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back({fmt::format("case-{}", i), {"width", 1.0 + true_sigma * random.normal(i), U, 1.0}});
  return out;
}

const Claim* claimOf(const std::vector<Claim>& claims, const std::string& what) {
  const auto at = std::ranges::find(claims, what, &Claim::what);
  return at == claims.end() ? nullptr : &*at;
}

Claim::State coverageState(std::size_t cases, double true_sigma, double U) {
  GaugeSection section;
  section.coverage = {coverageOf("width", readings(cases, true_sigma, U))};
  return claimOf(claimsOf(section), "95 % intervals hold the truth: width")->state;
}

TEST(Coverage, OfARightUncertaintyIs95Percent) {
  const Coverage c = coverageOf("width", readings(4000, 0.5, 1.0));
  EXPECT_EQ(c.cases, 4000U);
  EXPECT_NEAR(static_cast<double>(c.hits) / 4000.0, 0.9545, 0.01);
  EXPECT_LT(c.share.low, 0.9545);
  EXPECT_GT(c.share.high, 0.9545);
  EXPECT_NEAR(c.z_sigma, 1.0, 0.03);
  EXPECT_NEAR(c.error_mm.sigma, 0.5, 0.02);
}

TEST(Coverage, CountsWhatWasNotMeasuredAsMissing) {
  auto some = readings(10, 0.1, 1.0);
  some.push_back({"case-x", {"width", kNan, 1.0, 1.0}});
  const Coverage c = coverageOf("width", some);
  EXPECT_EQ(c.cases, 10U);
  EXPECT_EQ(c.missing, 1U);
  GaugeSection section;
  section.coverage = {c};
  EXPECT_EQ(claimOf(claimsOf(section), "measured at all: width")->state, Claim::State::kFails);
}

TEST(Coverage, InOtherWorldsOneOfFiftyMayBeHidden) {
  const auto state = [](std::size_t measured) {
    auto some = readings(measured, 0.5, 1.0);
    some.push_back({"case-x", {"width", kNan, 1.0, 1.0}});
    GaugeSection section;
    section.mismatch = true;
    section.coverage = {coverageOf("width", some)};
    return claimOf(claimsOf(section), "measured at all: width")->state;
  };
  EXPECT_EQ(state(49), Claim::State::kHolds);
  EXPECT_EQ(state(48), Claim::State::kFails);
}

TEST(Coverage, MayBeTooLargeInTheBenchsOwnWorldAlone) {
  GaugeSection section;
  section.coverage = {coverageOf("width", readings(2000, 0.2, 1.0))};
  const auto state = [&] {
    return claimOf(claimsOf(section), "95 % intervals hold the truth: width")->state;
  };
  EXPECT_EQ(state(), Claim::State::kFails);
  section.coverage[0].two_sided = false;
  EXPECT_EQ(state(), Claim::State::kHolds);
  section.coverage = {coverageOf("width", readings(2000, 0.7, 1.0))};
  section.coverage[0].two_sided = false;
  EXPECT_EQ(state(), Claim::State::kFails);
}

TEST(Coverage, NamesTheCasesThatMissByMost) {
  auto some = readings(20, 0.01, 1.0);
  some[7].second.value = 4.0;
  some[11].second.value = -6.0;
  EXPECT_EQ(coverageOf("width", some).worst, (std::vector<std::string>{"case-11", "case-7"}));
}

TEST(CoverageClaim, IsTold) {
  EXPECT_EQ(coverageState(4000, 0.5, 1.0), Claim::State::kHolds);
  EXPECT_EQ(coverageState(4000, 0.65, 1.0), Claim::State::kFails);  // U too small
  EXPECT_EQ(coverageState(4000, 0.35, 1.0), Claim::State::kFails);  // U too large
}

TEST(CoverageClaim, IsMadeOfWhatACheckJudgesByOfEachCutAndOfAll) {
  // stillness_peak judges by excursions; a peak is shown for people.
  StillOutcome outcome;
  for (const char* quantity : {"excursion of a cut", "peak of a cut", "largest excursion of all cuts"})
    outcome.readings.push_back({quantity, 1.0, 0.5, 1.0});
  const CaseId id{twin::Preset::kStatic, Study::kStill, 0};
  for (const bool mismatch : {false, true}) {
    const GaugeSection section = sectionOf("static", {}, {{id, outcome}}, mismatch);
    EXPECT_EQ(section.coverage.size(), 3U);
    const std::vector<Claim> claims = claimsOf(section);
    EXPECT_NE(claimOf(claims, "95 % intervals hold the truth: excursion of a cut"), nullptr);
    EXPECT_NE(claimOf(claims, "95 % intervals hold the truth: largest excursion of all cuts"), nullptr);
    EXPECT_EQ(claimOf(claims, "95 % intervals hold the truth: peak of a cut"), nullptr);
  }
}

TEST(CoverageClaim, OfFewCasesIsOpenUnlessTheyShowTheContrary) {
  EXPECT_EQ(coverageState(50, 0.5, 1.0), Claim::State::kOpen);
  EXPECT_EQ(coverageState(200, 1.0, 1.0), Claim::State::kFails);
}

KerfOutcome outcome(const char* name, FaultKind kind, double truth_mm, inspect::Verdict verdict) {
  KerfOutcome o;
  o.name = name;
  o.kind = kind;
  o.truth_mm = truth_mm;
  o.verdict = o.path_verdict = verdict;
  return o;
}

TEST(VerdictClaims, OneBadCutThatPassesFails) {
  const auto section = sectionOf("static",
                                 {{{twin::Preset::kStatic, Study::kBad, 0},
                                   outcome("a", FaultKind::kBump, 0.06, inspect::Verdict::kPass)},
                                  {{twin::Preset::kStatic, Study::kBad, 1},
                                   outcome("b", FaultKind::kWave, 0.06, inspect::Verdict::kNotProven)}},
                                 {});
  const auto claims = claimsOf(section);
  EXPECT_EQ(claimOf(claims, "bad cuts that PASS: bump")->state, Claim::State::kFails);
  EXPECT_EQ(claimOf(claims, "bad cuts that PASS: wave")->state, Claim::State::kHolds);
  ASSERT_EQ(section.wrong.size(), 1U);
  EXPECT_EQ(section.wrong[0], "a: PASS with a true deviation of 60.0 µm (bump)");
}

TEST(VerdictClaims, FewGoodCutsCanOnlyShowThatTooManyStayOpen) {
  const auto stateOf = [](std::size_t open) {
    std::vector<std::pair<CaseId, KerfOutcome>> cases;
    for (std::size_t i = 0; i < 150; ++i)
      cases.push_back({{twin::Preset::kStatic, Study::kGood, i},
                       outcome("g", FaultKind::kOffset, 0.03,
                               i < open ? inspect::Verdict::kNotProven : inspect::Verdict::kPass)});
    return claimOf(claimsOf(sectionOf("static", cases, {})), "good cuts NOT PROVEN")->state;
  };
  EXPECT_EQ(stateOf(0), Claim::State::kOpen);
  EXPECT_EQ(stateOf(2), Claim::State::kOpen);
  // At 1 %, 4 of 1000 studies of 150 cuts have so many.
  EXPECT_EQ(stateOf(6), Claim::State::kFails);
}

TEST(VerdictClaims, GoodCutsMayNotFailNorOftenStayOpen) {
  std::vector<std::pair<CaseId, KerfOutcome>> cases;
  for (std::size_t i = 0; i < 1000; ++i)
    cases.push_back({{twin::Preset::kStatic, Study::kGood, i},
                     outcome("g", FaultKind::kOffset, 0.03,
                             i < 10 ? inspect::Verdict::kNotProven : inspect::Verdict::kPass)});
  EXPECT_EQ(claimOf(claimsOf(sectionOf("static", cases, {})), "good cuts NOT PROVEN")->state,
            Claim::State::kHolds);
  cases[10].second.verdict = inspect::Verdict::kNotProven;
  EXPECT_EQ(claimOf(claimsOf(sectionOf("static", cases, {})), "good cuts NOT PROVEN")->state,
            Claim::State::kFails);
  cases[2].second.verdict = inspect::Verdict::kFail;
  EXPECT_EQ(claimOf(claimsOf(sectionOf("static", cases, {})), "good cuts that FAIL")->state,
            Claim::State::kFails);
  cases[3].second.verdict = inspect::Verdict::kInvalid;
  EXPECT_EQ(
      claimOf(claimsOf(sectionOf("static", cases, {})), "cuts that could not be measured (INVALID)")->state,
      Claim::State::kFails);
}

TEST(VerdictClaims, AnOpenClaimDoesNotFailTheGauge) {
  GaugeResult result;
  result.claims = {{"static", "x", "1", "2", Claim::State::kHolds},
                   {"static", "y", "1", "2", Claim::State::kOpen}};
  EXPECT_TRUE(result.holds());
  result.claims.push_back({"static", "z", "1", "2", Claim::State::kFails});
  EXPECT_FALSE(result.holds());
}

TEST(Detectability, IsTheLimitAndWhatTheStatementLagsBehind) {
  std::vector<std::pair<CaseId, KerfOutcome>> cases;
  for (std::size_t i = 0; i < 60; ++i) {
    // The lower end of the stated interval lies 1 um below the truth, in one case 3 um.
    KerfOutcome o = outcome("b", FaultKind::kScale, 0.07, inspect::Verdict::kFail);
    o.readings = {{"worst of all lines", 0.07, i == 5 ? 0.003 : 0.001, 0.07}};
    cases.push_back({{twin::Preset::kStatic, Study::kBad, i}, o});
  }
  const GaugeSection s = sectionOf("static", cases, {});
  const auto at = std::ranges::find(s.kinds, FaultKind::kScale, &KindResult::kind);
  EXPECT_NEAR(at->detectable_mm, 0.053, 1e-9);
  EXPECT_EQ(at->detectable_from, 60U);
}

TEST(FieldMap, FindsAShiftThatReadingsOfAllDirectionsShow) {
  std::vector<std::pair<CaseId, KerfOutcome>> cases;
  const CounterRandom random(5, 5);
  KerfOutcome o = outcome("c", FaultKind::kOffset, 0.03, inspect::Verdict::kPass);
  const Eigen::Vector2d shift(0.002, -0.001);
  for (std::size_t i = 0; i < 400; ++i) {
    const double angle = 6.28318 * random.uniform(i);
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    o.field.push_back({{12.0, -7.0}, normal, normal.dot(shift) + 1e-5 * random.normal(1000 + i)});
  }
  cases.push_back({{twin::Preset::kStatic, Study::kGood, 0}, o});
  const GaugeSection s = sectionOf("static", cases, {});
  ASSERT_EQ(s.field.size(), 1U);
  EXPECT_NEAR((s.field[0].bias_mm - shift).norm(), 0.0, 5e-6);
  EXPECT_NEAR(s.field[0].p_V_mm.x(), 12.5, 1e-9);
  EXPECT_EQ(s.field[0].readings, 400U);
}

}  // namespace
}  // namespace kerfbench::gauge

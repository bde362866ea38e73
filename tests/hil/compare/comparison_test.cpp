// SPDX-License-Identifier: Apache-2.0
#include "hil/compare/comparison.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/compare/write_comparison.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/compare/kept_verdict.h"

namespace kerfbench::compare {
namespace {

using testing::HasSubstr;

RunFigures plainRun() {
  RunFigures run;
  run.scenario = "label";
  run.firmware_sha256 = "aa11";
  run.verdict = "PASS";
  run.imperfections = "ideal";
  run.seed = 1;
  run.checks["path"] = {"PASS", "unit 0, E0", 0.05, "mm"};
  run.checks["account"] = {"PASS", "", 0.0, "counts"};
  run.figures = {{Figure::Of::kCheck, "path", "value", "mm", 0.010, 0.002, Better::kSmaller},
                 {Figure::Of::kCheck, "account", "value", "counts", 0.0, 0.0, Better::kSmaller},
                 {Figure::Of::kCut, "unit 0, E0", "slope_mm_s", "mm/s", -0.002, 0.001, Better::kNearZero},
                 {Figure::Of::kEntity, "unit 0, E0", "width_mm", "mm", 0.2, 0.005, Better::kNeither},
                 {Figure::Of::kCheck, "dose", "value", "%", 80.0, 1.0, Better::kLarger}};
  return run;
}

Figure& figureOf(RunFigures& run, const std::string& quantity, const std::string& place = "") {
  return *std::ranges::find_if(run.figures, [&](const Figure& f) {
    return f.quantity == quantity && (place.empty() || f.place == place);
  });
}

Comparison compared(const RunFigures& before, const RunFigures& after) {
  return compareReleases({"old", {before}}, {"new", {after}});
}

const Difference& differenceOf(const Comparison& comparison, const std::string& place,
                               const std::string& quantity) {
  return *std::ranges::find_if(comparison.differences, [&](const Difference& d) {
    return d.place == place && d.quantity == quantity;
  });
}

TEST(Comparison, ARunIsLikeItself) {
  const Comparison same = compared(plainRun(), plainRun());
  EXPECT_FALSE(same.anythingWorse());
  EXPECT_TRUE(same.cautions.empty() && same.verdicts.empty() && same.only_old.empty() &&
              same.only_new.empty());
  EXPECT_EQ(same.differences.size(), plainRun().figures.size());
}

TEST(Comparison, ADifferenceBeyondItsUncertaintyIsWorseBetterOrAnother) {
  RunFigures after = plainRun();
  figureOf(after, "value", "path").value = 0.030;
  figureOf(after, "value", "dose").value = 95.0;
  figureOf(after, "width_mm").value = 0.3;
  const Comparison comparison = compared(plainRun(), after);
  const Difference& path = differenceOf(comparison, "path", "value");
  EXPECT_TRUE(path.worse);
  EXPECT_DOUBLE_EQ(path.u, 2.0 * std::hypot(0.002, 0.002));
  EXPECT_TRUE(differenceOf(comparison, "dose", "value").better);
  const Difference& width = differenceOf(comparison, "unit 0, E0", "width_mm");
  EXPECT_TRUE(width.significant && !width.worse && !width.better);
  EXPECT_TRUE(comparison.anythingWorse());
  EXPECT_FALSE(compared(after, after).anythingWorse());
}

TEST(Comparison, WithinTheLimitAndWithinTheUncertaintyIsNothing) {
  RunFigures after = plainRun();
  figureOf(after, "value", "path").value = 0.016;
  EXPECT_FALSE(compared(plainRun(), after).anythingWorse());
}

// Signs count: a slope of +0.02 for -0.002 mm/s is worse, one of +0.002 is as good.
TEST(Comparison, ASignedFigureIsWorseFartherFromZero) {
  RunFigures after = plainRun();
  figureOf(after, "slope_mm_s").value = 0.02;
  EXPECT_TRUE(differenceOf(compared(plainRun(), after), "unit 0, E0", "slope_mm_s").worse);
  EXPECT_TRUE(differenceOf(compared(after, plainRun()), "unit 0, E0", "slope_mm_s").better);
  RunFigures mirrored = after;
  figureOf(mirrored, "slope_mm_s").value = -0.02;
  const Comparison turned = compared(after, mirrored);
  EXPECT_TRUE(differenceOf(turned, "unit 0, E0", "slope_mm_s").significant);
  EXPECT_FALSE(turned.anythingWorse());
}

TEST(Comparison, AWorseVerdictCountsWithItsValue) {
  RunFigures after = plainRun();
  after.checks["path"].verdict = "NOT PROVEN";
  figureOf(after, "value", "path").value = 0.012;
  EXPECT_FALSE(compared(plainRun(), after).anythingWorse());
  after.checks["path"].verdict = "INVALID";
  EXPECT_TRUE(compared(plainRun(), after).anythingWorse());
  RunFigures counted = plainRun();
  counted.checks["account"].verdict = "FAIL";
  figureOf(counted, "value", "account").value = 3.0;
  EXPECT_TRUE(compared(plainRun(), counted).anythingWorse());
}

TEST(Comparison, ACheckThatIsNotJudgedAnyMoreIsWorse) {
  RunFigures after = plainRun();
  after.checks.erase("path");
  after.not_judged["path"] = "Too few frames.";
  const Comparison comparison = compared(plainRun(), after);
  ASSERT_EQ(comparison.verdicts.size(), 1U);
  EXPECT_EQ(comparison.verdicts[0].new_verdict, "not judged");
  EXPECT_EQ(comparison.verdicts[0].why, "Too few frames.");
  EXPECT_TRUE(comparison.anythingWorse());
  EXPECT_FALSE(compared(after, plainRun()).anythingWorse());
}

// Another seed draws another machine: one run of each does not show what the release did.
TEST(Comparison, MachinesSampledAnewAreNotHeldAgainstTheRelease) {
  RunFigures before = plainRun(), after = plainRun();
  before.imperfections = after.imperfections = "static";
  figureOf(after, "slope_mm_s").value = 0.02;
  EXPECT_TRUE(compared(before, after).anythingWorse()) << "the same seed is the same machine";
  after.seed = 2;
  const Comparison other = compared(before, after);
  EXPECT_FALSE(other.told_apart || other.anythingWorse());
  EXPECT_THAT(other.cautions, testing::Contains(HasSubstr("run both releases with one --seed")));
}

/// Runs whose slopes are these.
RunSet runsOf(const std::vector<double>& slopes, std::uint64_t first_seed, const std::string& firmware) {
  RunSet set;
  for (const double slope : slopes) {
    RunFigures run = plainRun();
    run.imperfections = "static";
    run.seed = first_seed++;
    run.firmware_sha256 = firmware;
    figureOf(run, "slope_mm_s").value = slope;
    set.runs.push_back(run);
  }
  return set;
}

TEST(Comparison, ManyRunsShowHowFarMachinesDiffer) {
  const std::vector<double> machines{0.010, -0.012, 0.004, -0.006, 0.009, -0.003};
  std::vector<double> other = machines;
  for (double& slope : other) slope = -slope + 0.002;
  EXPECT_FALSE(compareReleases(runsOf(machines, 1, "a"), runsOf(other, 101, "b")).anythingWorse());
  for (double& slope : other) slope += 0.08;
  EXPECT_TRUE(compareReleases(runsOf(machines, 1, "a"), runsOf(other, 101, "b")).anythingWorse());
}

// The same machines in both: what they have in common drops out, and a tenth of their spread is seen.
TEST(Comparison, PairsOfOneSeedShowWhatIsSmallerThanTheSpread) {
  const std::vector<double> machines{0.10, -0.12, 0.04, -0.06, 0.09, -0.03};
  std::vector<double> shifted = machines;
  for (double& slope : shifted) slope += 0.01;
  const Comparison pairs = compareReleases(runsOf(machines, 1, "a"), runsOf(shifted, 1, "b"));
  EXPECT_TRUE(differenceOf(pairs, "unit 0, E0", "slope_mm_s").significant);
  EXPECT_FALSE(differenceOf(compareReleases(runsOf(machines, 1, "a"), runsOf(shifted, 11, "b")), "unit 0, E0",
                            "slope_mm_s")
                   .significant);
}

// 2000 comparisons of 300 figures that differ by noise alone: false alarms are as rare as is stated.
TEST(Comparison, FalseAlarmsAreAsRareAsStated) {
  std::mt19937 random(20261128);
  std::normal_distribution<double> noise;
  const auto noisy = [&] {
    RunFigures run;
    run.scenario = "label";
    for (int i = 0; i < 300; ++i)
      run.figures.push_back({Figure::Of::kCut, std::to_string(i), "offset_mm", "mm", 0.003 * noise(random),
                             0.003, Better::kNearZero});
    return run;
  };
  int alarms = 0;
  for (int i = 0; i < 1000; ++i) {
    const Comparison comparison = compared(noisy(), noisy());
    alarms += std::ranges::any_of(comparison.differences, &Difference::significant) ? 1 : 0;
  }
  EXPECT_LE(alarms, 13);  // 5 are expected; more than 13 have a chance below 0.1 %.
  EXPECT_GE(alarms, 1);
}

TEST(Comparison, OtherJobsAndMixedReleasesAreRefused) {
  RunFigures other = plainRun();
  other.scenario = "carton";
  EXPECT_THROW((void)compared(plainRun(), other), base::InputError);
  RunFigures release = plainRun();
  release.firmware_sha256 = "bb22";
  EXPECT_THROW((void)compareReleases({"old", {plainRun(), release}}, {"new", {plainRun()}}),
               base::InputError);
}

TEST(Comparison, WhatElseIsAnotherIsSaid) {
  RunFigures before = plainRun(), after = plainRun();
  before.inputs = {{"machine.yaml", "1"}, {"a.hex", "aa11"}, {"same.dxf", "5"}};
  after.inputs = {{"machine.yaml", "2"}, {"a.hex", "bb22"}, {"same.dxf", "5"}};
  before.bench_version = "0.1.0";
  after.bench_version = "0.2.0";
  after.twin = "reference";
  EXPECT_THAT(compared(before, after).cautions,
              testing::ElementsAre(HasSubstr("0.1.0 and 0.2.0"), HasSubstr("other models"),
                                   testing::EndsWith("these files are too: machine.yaml")));
}

TEST(WriteComparison, TextIsEscapedAndFilesAreWhole) {
  RunFigures before = plainRun(), after = plainRun();
  before.firmware = "<script>alert(1)</script>";
  figureOf(after, "value", "path").value = 0.030;
  const ComparedReleases both{{"old", {before}}, {"new", {after}}, compared(before, after)};
  const base::TempFolder temp;
  writeComparison(both, temp.path() / "deep" / "compare");
  const std::string page = base::contentOf(temp.path() / "deep" / "compare" / "compare.html");
  EXPECT_THAT(page, testing::Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("</html>"));
  const auto json = nlohmann::json::parse(base::contentOf(temp.path() / "deep" / "compare" / "compare.json"));
  EXPECT_EQ(json.at("worse"), true);
  EXPECT_EQ(json.at("differences").at(0).at("place"), "path");
  EXPECT_EQ(json.at("differences").size(), plainRun().figures.size());
  EXPECT_THAT(comparisonLines(both),
              testing::Contains(HasSubstr("worse    check path: 0.0100 mm -> 0.0300 mm")));
}

}  // namespace
}  // namespace kerfbench::compare

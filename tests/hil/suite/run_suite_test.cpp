// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/run_suite.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "tests/hil/suite/small_suite.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunSuite : public testing::Test {
 protected:
  RunSuite() {
    for (const char* name : {"a", "b", "c"}) small_.scenario(name);
    small_.plan("runs: [{scenario: a.yaml}, {scenario: b.yaml, seeds: [1, 2]}, {scenario: c.yaml}]\n");
  }
  SmallSuite small_;
};

TEST_F(RunSuite, AllAsExpectedIsGood) {
  EXPECT_EQ(runQuietly(small_.options()), 0);
  EXPECT_EQ(small_.outcomes(), "as expected, as expected, as expected, as expected");
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nb 2\nc 1\n");
  const nlohmann::json summary = small_.summary();
  EXPECT_EQ(summary.at("exit_code"), 0);
  EXPECT_EQ(summary.at("complete"), true);
  EXPECT_EQ(summary.at("runs")[2].at("name"), "b-seed-2");
  EXPECT_EQ(summary.at("runs")[2].at("result").at("digest"), "d-b-2");
  EXPECT_TRUE(fs::exists(small_.latest() / "runs/b-seed-2/results/verdict.json"));
  EXPECT_TRUE(fs::exists(small_.latest() / "index.html"));
  EXPECT_TRUE(fs::exists(small_.latest() / "junit.xml"));
}

TEST_F(RunSuite, TheSummaryIsTheSameAtAnyNumberOfRunsAtOnceAndNamesNoTimes) {
  small_.act("b", "verdict=FAIL");
  EXPECT_EQ(runQuietly(small_.options()), 1);
  const std::string one_by_one = small_.summaryText();
  SuiteOptions options = small_.options();
  options.jobs = 4;
  options.results_dir = small_.folder() / "elsewhere";
  EXPECT_EQ(runQuietly(options), 1);
  EXPECT_EQ(base::contentOf(small_.folder() / "elsewhere/release/latest/summary.json"), one_by_one);
  EXPECT_THAT(one_by_one, testing::Not(HasSubstr("wall")));
  EXPECT_THAT(one_by_one, testing::Not(HasSubstr(small_.folder().string())));
}

TEST_F(RunSuite, AKnownBadReleaseMustFailByItsCheck) {
  small_.plan(
      "runs:\n"
      "  - {name: right, scenario: a.yaml, expect: FAIL, by: [path]}\n"
      "  - {name: wrong, scenario: a.yaml, expect: FAIL, by: [gate_lag]}\n"
      "  - {name: other, scenario: a.yaml, expect: FAIL, by: [belt]}\n"
      "  - {name: passed, scenario: b.yaml, expect: FAIL, by: [path]}\n");
  small_.act("a", "verdict=FAIL");
  EXPECT_EQ(runQuietly(small_.options()), 1);
  EXPECT_EQ(small_.outcomes(), "as expected, not as expected, not as expected, not as expected");
  const nlohmann::json runs = small_.summary().at("runs");
  EXPECT_EQ(runs[1].at("why"), "FAIL by path, and FAIL by gate_lag is expected; check gate_lag is PASS");
  EXPECT_EQ(runs[2].at("why"), "FAIL by path, and FAIL by belt is expected; check belt was not made");
  EXPECT_EQ(runs[3].at("why"), "PASS, and FAIL by path is expected");
  EXPECT_EQ(runs[3].at("exit_code"), 1);
}

TEST_F(RunSuite, TheExitCodeIsTheWorstOfWhatIsNotAsExpected) {
  small_.act("a", "verdict='NOT PROVEN'");
  EXPECT_EQ(runQuietly(small_.options()), 4);
  small_.act("b", "verdict=FAIL");
  EXPECT_EQ(runQuietly(small_.options()), 1);
  small_.act("c", "verdict=INVALID");
  EXPECT_EQ(runQuietly(small_.options()), 3);
  small_.plan("runs: [{scenario: a.yaml, expect: NOT PROVEN}, {scenario: c.yaml, expect: INVALID}]\n");
  EXPECT_EQ(runQuietly(small_.options()), 0);
}

TEST_F(RunSuite, ARunThatBreaksIsOneRowAndTheOthersGoOn) {
  small_.act("a", "echo 'last words'; kill -SEGV $$");
  small_.act("b", "[ $seed = 2 ] && { echo 'b.yaml:3: bad'; exit 65; }");
  small_.act("c", "exit 0");  // Without a verdict.
  EXPECT_EQ(runQuietly(small_.options()), 2);
  EXPECT_EQ(small_.outcomes(), "broken, as expected, broken, broken");
  const nlohmann::json runs = small_.summary().at("runs");
  EXPECT_EQ(runs[0].at("why"), "was ended by signal 11 (Segmentation fault): last words");
  EXPECT_EQ(runs[2].at("why"), "ended with exit code 65: b.yaml:3: bad");
  EXPECT_EQ(runs[2].at("exit_code"), 65);
  EXPECT_THAT(runs[3].at("why").get<std::string>(), HasSubstr("verdict.json: is not there"));
}

TEST_F(RunSuite, AnExitCodeThatBeliesTheVerdictIsNotTrusted) {
  small_.act("a", "trap 'exit 0' EXIT; verdict=FAIL");
  EXPECT_EQ(runQuietly(small_.options()), 2);
  EXPECT_EQ(small_.summary().at("runs")[0].at("why"), "ended with exit code 0, and its verdict is FAIL");
}

TEST_F(RunSuite, NoRunIsStartedAfterSoManyThatAreNotAsExpected) {
  small_.act("b", "verdict=FAIL");
  SuiteOptions options = small_.options();
  options.stop_after = 1;
  EXPECT_EQ(runQuietly(options), 1);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\n");
  EXPECT_EQ(small_.outcomes(), "as expected, not as expected, not run, not run");
  EXPECT_EQ(small_.summary().at("complete"), false);
  EXPECT_EQ(small_.summary().at("runs")[3].at("why"), "not started: 1 run was not as expected");
  // What stopped it does not stop it again.
  options.resume.emplace();
  options.stop_after = 2;
  EXPECT_EQ(runQuietly(options), 1);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nb 2\nc 1\n");
  EXPECT_EQ(small_.summary().at("complete"), true);
}

TEST_F(RunSuite, ThePlansOwnRuleHoldsUnlessAnotherIsGiven) {
  small_.act("a", "verdict=FAIL");
  small_.plan("stop_after: 1\nruns: [{scenario: a.yaml}, {scenario: b.yaml}]\n");
  EXPECT_EQ(runQuietly(small_.options()), 1);
  EXPECT_EQ(small_.outcomes(), "not as expected, not run");
  SuiteOptions options = small_.options();
  options.stop_after = 0;
  EXPECT_EQ(runQuietly(options), 1);
  EXPECT_EQ(small_.outcomes(), "not as expected, as expected");
}

TEST_F(RunSuite, OnlyWhatWasNotAsExpectedIsRepeatedInASuiteOfItsOwn) {
  small_.act("b", "[ $seed = 1 ] && verdict=FAIL");
  small_.act("c", "exit 2");
  EXPECT_EQ(runQuietly(small_.options()), 2);
  const fs::path first = small_.latest();
  const std::string before = base::contentOf(first / "summary.json");
  small_.act("b", "");
  small_.act("c", "");
  SuiteOptions options = small_.options();
  options.failed.emplace();
  EXPECT_EQ(runQuietly(options), 0);
  EXPECT_EQ(small_.calls(), "a 1\nb 1\nb 2\nc 1\nb 1\nc 1\n");
  EXPECT_NE(small_.latest(), first);
  EXPECT_EQ(base::contentOf(first / "summary.json"), before);
  const nlohmann::json summary = small_.summary();
  EXPECT_EQ(summary.at("left_out"), 2);
  EXPECT_EQ(summary.at("part"), "not as expected in " + first.filename().string());
  EXPECT_THAT(errorOf<base::InputError>([&] { return runQuietly(options); }),
              HasSubstr("nothing is to be repeated"));
}

TEST_F(RunSuite, ASelectionSaysWhatItLeavesOut) {
  SuiteOptions options = small_.options();
  options.patterns = {"b-*"};
  EXPECT_EQ(runQuietly(options), 0);
  EXPECT_EQ(small_.calls(), "b 1\nb 2\n");
  EXPECT_EQ(small_.summary().at("part"), "name b-*");
  EXPECT_EQ(small_.summary().at("summary"), "2 of 2 runs as expected; 2 runs of the plan left out");
}

TEST_F(RunSuite, LimitsGoIntoTheScenarioThatTheRunIsGiven) {
  small_.plan("runs: [{name: tight, scenario: a.yaml, limits: {path_mm: 0.01}}]\n");
  EXPECT_EQ(runQuietly(small_.options()), 0);
  EXPECT_EQ(small_.calls(), "tight 1\n");
  EXPECT_THAT(base::contentOf(small_.latest() / "scenarios/tight.yaml"), HasSubstr("\"path_mm\": \"0.01\""));
}

TEST_F(RunSuite, AListRunsAndWritesNothing) {
  SuiteOptions options = small_.options();
  options.list = true;
  EXPECT_EQ(runQuietly(options), 0);
  EXPECT_EQ(small_.calls(), "");
  EXPECT_FALSE(fs::exists(options.results_dir));
}

TEST_F(RunSuite, TheRunsOfAScenarioAreNotMixedWithSuites) {
  const fs::path run = small_.folder() / "results/release/20261128T160512Z-1a2b3c4d";
  fs::create_directories(run);
  std::ofstream(run / "kerfbench-results.txt") << "";
  EXPECT_THAT(errorOf<base::InputError>([&] { return runQuietly(small_.options()); }),
              HasSubstr("holds the runs of a scenario"));
  EXPECT_EQ(small_.calls(), "");
}

TEST(SuiteProgress, TellsShareAndTimeLeft) {
  EXPECT_EQ(progressText(0, 12, 0, 0.0, 4, {"a", "b"}), "0 of 12 runs (0 %): a, b");
  EXPECT_EQ(progressText(5, 12, 1, 10.0, 4, {"a"}),
            "5 of 12 runs (41 %), 1 not as expected, about 18 s left: a");
  EXPECT_EQ(progressText(10, 12, 0, 100.0, 4, {}), "10 of 12 runs (83 %), about 2 min left");
}

}  // namespace
}  // namespace kerfbench::suite

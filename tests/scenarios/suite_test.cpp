// SPDX-License-Identifier: Apache-2.0
// A release test as a user runs it, from the plan to the exit code.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// A plan of one label that must be good and of one that a known defect spoils.
fs::path planOfTwo(const ScratchFolder& scratch) {
  (void)scenarioWith("native/label-on-belt.yaml", "name: label\nprint: {units: 1}\n", scratch);
  std::ofstream(scratch.path() / "plan.yaml")
      << "version: 1\nname: release\ndefaults: {twin: fast, seeds: [3]}\n"
         "runs:\n"
         "  - scenario: variant.yaml\n"
         "  - name: encoder-scale\n"
         "    scenario: variant.yaml\n"
         "    image: "
      << releaseImage("fault-encoder-scale-native").string()
      << "\n    expect: FAIL\n"
         "    by: [path]\n";
  return scratch.path() / "plan.yaml";
}

ProgramRun suite(const fs::path& plan, const ScratchFolder& scratch, const std::string& options) {
  return kerfbench(fmt::format("suite '{}' --results-dir '{}' --no-pictures {}", plan.string(),
                               (scratch.path() / "results").string(), options));
}

TEST(Suite, OfAGoodReleaseAndAKnownBadOneIsAsExpected) {
  const ScratchFolder scratch;
  const fs::path plan = planOfTwo(scratch);
  const ProgramRun run = suite(plan, scratch, "--jobs 2");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("release: 2 of 2 runs as expected\n"));
  const fs::path folder = scratch.path() / "results/release/latest";
  const std::string bytes = textOf(folder / "summary.json");
  const auto summary = nlohmann::json::parse(bytes);
  const auto& good = summary.at("runs").at(0);
  const auto& bad = summary.at("runs").at(1);
  EXPECT_EQ(good.at("name"), "label-seed-3");
  EXPECT_EQ(good.at("result").at("verdict"), "PASS");
  EXPECT_EQ(good.at("result").at("seed"), 3);
  EXPECT_EQ(bad.at("result").at("verdict"), "FAIL");
  // Each run has left what a run leaves, as its verdict has it.
  const fs::path results = folder / "runs/label-seed-3/results";
  EXPECT_EQ(verdictOf(results).at("digest"), good.at("result").at("digest"));
  EXPECT_TRUE(fs::exists(folder / good.at("result").at("report").get<std::string>()));
  EXPECT_EQ(kerfbench(fmt::format("verify '{}'", results.string())).exit_code, 0);
  // Suites of two releases can be compared run by run; this one with itself.
  const std::string suites = (scratch.path() / "results/release").string();
  const ProgramRun compared = kerfbench(
      fmt::format("compare '{0}' '{0}' --out '{1}'", suites, (scratch.path() / "compare").string()));
  EXPECT_EQ(compared.exit_code, 0) << compared.output;
  EXPECT_TRUE(fs::exists(scratch.path() / "compare/label-seed-3/compare.html"));
  EXPECT_TRUE(fs::exists(scratch.path() / "compare/encoder-scale-seed-3/compare.html"));
  // Nothing is left to run, and nothing is changed by that.
  const ProgramRun again = suite(plan, scratch, "--resume --jobs 1");
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, Not(HasSubstr("[2/2]")));
  EXPECT_EQ(textOf(folder / "summary.json"), bytes);
}

TEST(Suite, RefusesAnImageThatDoesNotFitBeforeAnythingRuns) {
  const ScratchFolder scratch;
  const ProgramRun run = suite(planOfTwo(scratch), scratch,
                               fmt::format("--image '{}'", releaseImage("controller-avr.hex").string()));
  EXPECT_EQ(run.exit_code, 65) << run.output;
  EXPECT_THAT(run.output, HasSubstr("plan.yaml:5: label-seed-3: "));
  EXPECT_THAT(run.output, HasSubstr("does not fit its controller"));
  EXPECT_FALSE(fs::exists(scratch.path() / "results"));
}

TEST(Suite, ReadsItsCommandLineAsThePageSays) {
  const ScratchFolder scratch;
  const fs::path plan = planOfTwo(scratch);
  const ProgramRun list = suite(plan, scratch, "--list --only 'enc*'");
  EXPECT_EQ(list.exit_code, 0) << list.output;
  EXPECT_THAT(list.output, HasSubstr("encoder-scale-seed-3  variant.yaml  expected FAIL by path"));
  EXPECT_THAT(list.output, HasSubstr("1 to run, 1 left out"));
  EXPECT_EQ(suite(plan, scratch, "--resume").exit_code, 65);
  EXPECT_EQ(suite(plan, scratch, "--resume --image x.hex").exit_code, 64);
  EXPECT_EQ(suite(plan, scratch, "--resume --failed").exit_code, 64);
  EXPECT_EQ(kerfbench("run a.yaml b.yaml --output x").exit_code, 64);
}

}  // namespace
}  // namespace kerfbench::test

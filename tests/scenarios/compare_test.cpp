// SPDX-License-Identifier: Apache-2.0
// Releases beside each other, from runs to exit code.
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

const std::string kOneLabel = "name: label\nprint: {units: 1}\n";

/// A label on the belt whose controller takes a count of the encoder for so much, mm.
fs::path labelWithCount(const std::string& count_mm, const ScratchFolder& scratch) {
  std::ofstream(scratch.path() / "machine.yaml")
      << fmt::format("extends: '{}'\ncontroller: {{encoder_count_mm: {}}}\n",
                     fixture("machines/two-mirror.yaml").string(), count_mm);
  return scenarioWith("native/label-on-belt.yaml", kOneLabel + "machine: machine.yaml\n", scratch);
}

ProgramRun compare(const std::string& arguments, const ScratchFolder& scratch) {
  return kerfbench(fmt::format("compare {} --out '{}'", arguments, (scratch.path() / "compare").string()));
}

// 0.02 % of the encoder's scale is within every limit, and is seen; another seed is not.
TEST(Compare, TellsASmallErrorOfTheEncodersScaleFromNoise) {
  const ScratchFolder before, again, after;
  ASSERT_EQ(fastRunOf(labelWithCount("0.01", before), before, "--seed 1").exit_code, 0);
  ASSERT_EQ(fastRunOf(labelWithCount("0.01", again), again, "--seed 2").exit_code, 0);
  ASSERT_EQ(fastRunOf(labelWithCount("0.010002", after), after, "--seed 3").exit_code, 0);
  const auto with = [&](const ScratchFolder& other) {
    return compare(
        fmt::format("'{}' '{}'", (before.path() / "label").string(), (other.path() / "label").string()),
        before);
  };
  const ProgramRun same = with(again);
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_THAT(same.output, HasSubstr("label: 0 figures worse"));
  const ProgramRun worse = with(after);
  EXPECT_EQ(worse.exit_code, 1) << worse.output;
  EXPECT_THAT(worse.output, HasSubstr("worse    cut offset_mm of unit 0, E4"));
  EXPECT_THAT(worse.output, HasSubstr("these files are too: machine.yaml"));
  EXPECT_THAT(textOf(before.path() / "compare" / "compare.html"), HasSubstr("</html>"));
}

TEST(Compare, RefusesWhatIsNoRunAndSaysWhy) {
  const ScratchFolder scratch;
  fs::create_directories(scratch.path() / "empty");
  const std::string empty = (scratch.path() / "empty").string();
  const ProgramRun none = compare(fmt::format("'{0}' '{0}'", empty), scratch);
  EXPECT_EQ(none.exit_code, 65);
  EXPECT_THAT(none.output, HasSubstr("holds no verdict.json, and no runs of a scenario"));
  EXPECT_EQ(compare("", scratch).exit_code, 64);
  EXPECT_EQ(compare(fmt::format("'{0}' '{0}' --history '{0}'", empty), scratch).exit_code, 64);
  EXPECT_EQ(kerfbench("history nothing --results-dir '" + empty + "'").exit_code, 65);
}

// Runs pile up beside each other; the older ones go when they are told to.
TEST(Compare, HistoryAndPruneSeeTheRunsOfAScenario) {
  const ScratchFolder scratch;
  const fs::path label = labelWithCount("0.01", scratch);
  for (const char* seed : {"--seed 1", "--seed 2"}) ASSERT_EQ(fastRunOf(label, scratch, seed).exit_code, 0);
  const std::string where = fmt::format("label --results-dir '{}'", scratch.path().string());
  const ProgramRun history = kerfbench("history " + where);
  EXPECT_EQ(history.exit_code, 0) << history.output;
  EXPECT_THAT(history.output, testing::AllOf(HasSubstr("seed 1"), HasSubstr("seed 2")));
  EXPECT_THAT(kerfbench("prune --keep 1 --dry-run " + where).output, HasSubstr("1 run to remove"));
  EXPECT_THAT(kerfbench("prune --keep 1 " + where).output, HasSubstr("1 run removed"));
  EXPECT_EQ(verdictOf(scratch.path() / "label").at("seed"), 2);
}

}  // namespace
}  // namespace kerfbench::test

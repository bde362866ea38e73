// SPDX-License-Identifier: Apache-2.0
// Five-axis cuts over folded blanks, from scenario file to exit code: the good ones pass, and each bad one
// fails by the check that must find it.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

ProgramRun foldRun(const std::string& scenario, const ScratchFolder& scratch, const std::string& more = "") {
  return kerfbench(fmt::format("fold '{}' --results-dir '{}' {}",
                               fixture("fold/" + scenario + ".yaml").string(), scratch.path().string(),
                               more));
}

nlohmann::json foldVerdict(const ScratchFolder& scratch) {
  return nlohmann::json::parse(textOf(scratch.path() / "fold.json"));
}

void passes(const std::string& scenario) {
  const ScratchFolder scratch;
  const ProgramRun run = foldRun(scenario, scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const nlohmann::json verdict = foldVerdict(scratch);
  EXPECT_EQ(verdict.at("verdict"), "PASS");
  EXPECT_EQ(verdict.at("checks").size(), 4U);
  EXPECT_TRUE(checksThat(verdict, "PASS").size() == 4U);
  // The guard band is worth something: U is neither nothing nor as large as the limit.
  EXPECT_GT(verdict.at("worst").at("U_mm").get<double>(), 0.004);
  EXPECT_LT(verdict.at("worst").at("U_mm").get<double>(), 0.04);
}

void fails(const std::string& scenario, const std::string& check) {
  const ScratchFolder scratch;
  const ProgramRun run = foldRun("faults/" + scenario, scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(foldVerdict(scratch), "FAIL"), Contains(check)) << run.output;
}

TEST(Fold, ABoxCornerCompensatedToTheLeftPasses) { passes("box-corner-left"); }
TEST(FoldLong, ABoxCornerCompensatedToTheRightPasses) { passes("box-corner-right"); }
TEST(FoldLong, AShallowEdgePasses) { passes("shallow-edge"); }

TEST(Fold, TheBeamOnTheContourFails) { fails("uncompensated", "space_path"); }
TEST(Fold, AWrongPivotLengthFails) { fails("pivot-length", "space_path"); }
TEST(FoldLong, AWrongZeroOfAFails) { fails("a-zero", "space_path"); }
TEST(Fold, AFoldOf91DegreesFails) { fails("fold-angle", "space_path"); }
TEST(Fold, ThePapersLiteralJointFailsWhereItBurns) { fails("paper-joint", "space_joints"); }

TEST(FoldLong, TheOtherFaultsFail) {
  fails("wrong-side", "space_path");
  fails("c-zero", "space_path");
  fails("narrow-compensation", "space_path");
  fails("turn-burns", "space_joints");
}

TEST(FoldLong, NoSeedTurnsGoodIntoBad) {
  for (const int seed : {2, 3, 4, 5, 6}) {
    const ScratchFolder scratch;
    const auto scenario = scratch.path() / "seed.yaml";
    std::ofstream(scenario) << fmt::format("extends: '{}'\nname: seed\nseed: {}\n",
                                           fixture("fold/box-corner-left.yaml").string(), seed);
    const ProgramRun run =
        kerfbench(fmt::format("fold '{}' --results-dir '{}'", scenario.string(), scratch.path().string()));
    EXPECT_EQ(run.exit_code, 0) << run.output;
  }
}

TEST(Fold, TheSameBytesComeFromAnyNumberOfThreadsAndThePageIsWhole) {
  const ScratchFolder one;
  const ScratchFolder two;
  (void)foldRun("shallow-edge", one, "--jobs 1 --quiet");
  (void)foldRun("shallow-edge", two, "--jobs 2 --quiet");
  EXPECT_EQ(foldVerdict(one).at("digest"), foldVerdict(two).at("digest"));
  const std::string page = textOf(one.path() / "report.html");
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(textOf(one.path() / "junit.xml"), HasSubstr("tests=\"5\" failures=\"0\" errors=\"0\""));
  EXPECT_THAT(textOf(one.path() / "program.gcode"), HasSubstr("G01 X"));
}

TEST(Fold, ABadScenarioIsRefusedWithEveryFault) {
  const ScratchFolder scratch;
  const auto scenario = scratch.path() / "bad.yaml";
  std::ofstream(scenario) << fmt::format("extends: '{}'\nkerf: {{radius_mm: 9}}\nlimit: 1\n",
                                         fixture("fold/shallow-edge.yaml").string());
  const ProgramRun run =
      kerfbench(fmt::format("fold '{}' --results-dir '{}/r'", scenario.string(), scratch.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, HasSubstr("bad.yaml:2: kerf.radius_mm"));
  EXPECT_THAT(run.output, HasSubstr("bad.yaml:3: limit"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "r"));
}

}  // namespace
}  // namespace kerfbench::test

// SPDX-License-Identifier: Apache-2.0
// What the programs do alike with a command line that is empty, mistyped or asks for a page.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CommandLine, WithoutAnyWordIsAnsweredByTheHelpAndIsNoPass) {
  for (const char* name : {"kerfbench", "kerfplan"}) {
    const ProgramRun run = program(name, "");
    EXPECT_EQ(run.exit_code, 64) << name;
    EXPECT_THAT(run.output, HasSubstr("Subcommands:")) << name;
    // On standard error, and nothing on standard output.
    EXPECT_EQ(program(name, "2>/dev/null; :").output, "") << name;
  }
}

TEST(CommandLine, ThatIsMistypedIsToldWithWhatWasMeant) {
  const ProgramRun command = kerfbench("rnu plate.yaml");
  EXPECT_EQ(command.exit_code, 64);
  EXPECT_THAT(command.output, HasSubstr("kerfbench: there is no command 'rnu'. Did you mean run?"));
  EXPECT_THAT(kerfbench("lint plate.yaml --qiuet").output,
              HasSubstr("kerfbench lint: there is no option '--qiuet'. Did you mean --quiet?"));
  EXPECT_THAT(kerfbench("calibrate haed").output,
              HasSubstr("kerfbench calibrate: there is no command 'haed'. Did you mean head?"));
  EXPECT_THAT(program("kerfplan", "chekc a.dxf").output,
              HasSubstr("kerfplan: there is no command 'chekc'. Did you mean check?"));
  EXPECT_THAT(program("kerfplan", "check a.dxf --belt-sped 3").output,
              HasSubstr("Did you mean --belt-speed?"));
}

TEST(CommandLine, SaysForWhichCommandSomethingIsMissing) {
  EXPECT_THAT(kerfbench("replay pins.vcd").output, HasSubstr("kerfbench replay: --scenario is required"));
  EXPECT_THAT(kerfbench("replay pins.vcd").output, HasSubstr("kerfbench replay --help"));
}

TEST(CommandLine, TellsAMistypedKeyWithTheOneThatIsThere) {
  const ScratchFolder scratch;
  const auto scenario = scenarioWith("native/button.yaml", "planner: {mark_sped_mm_s: 50}", scratch);
  EXPECT_THAT(kerfbench("lint " + scenario.string()).output,
              HasSubstr("planner.mark_sped_mm_s: unknown key. Did you mean mark_speed_mm_s?"));
}

TEST(CommandLine, AsksTheOtherProgramForThePagesOfItsCommands) {
  EXPECT_THAT(kerfbench("man run").output, HasSubstr(".TH KERFBENCH\\-RUN 1"));
  EXPECT_THAT(kerfbench("man calibrate head").output, HasSubstr(".TH KERFBENCH\\-CALIBRATE\\-HEAD 1"));
  EXPECT_THAT(kerfbench("man rnu").output, HasSubstr("Did you mean kerfbench-run?"));
  EXPECT_THAT(program("kerfplan", "man library show").output, HasSubstr(".TH KERFPLAN\\-LIBRARY\\-SHOW 1"));
}

TEST(CommandLine, HasColoursWhereTheyAreWanted) {
  const std::string lint = "lint --color always " + fixture("scenarios/native/button.yaml").string();
  EXPECT_EQ(kerfbench(lint).exit_code, 0);
  EXPECT_EQ(kerfbench("run --color sometimes x.yaml").exit_code, 64);
  // Into a pipe nothing is coloured by itself.
  EXPECT_THAT(kerfbench("--help").output, Not(HasSubstr("\x1b[")));
}

TEST(CommandLine, OfKerfplanTakesGcodeFromStandardInput) {
  const std::string drawing = fixture("dielines/label-60x40.dxf").string();
  const std::string kerfplan = std::string(KERFBENCH_BINARY_DIR) + "/bin/kerfplan";
  const ProgramRun piped = program("kerfplan", "gcode " + drawing + " | " + kerfplan + " check -");
  EXPECT_EQ(piped.exit_code, 0) << piped.output;
  EXPECT_THAT(piped.output, HasSubstr("marks / jumps   210.557 mm"));
  const ProgramRun empty = program("kerfplan", "check - </dev/null");
  EXPECT_EQ(empty.exit_code, 65);
  EXPECT_THAT(empty.output, HasSubstr("standard input: G-code: it holds no line or arc"));
}

}  // namespace
}  // namespace kerfbench::test

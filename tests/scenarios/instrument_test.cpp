// SPDX-License-Identifier: Apache-2.0
// The commands whose code is in kerfbench-instrument, asked for as commands of kerfbench.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;

TEST(InstrumentCommands, AreInTheHelpWithTheWordsOfTheirOwn) {
  const std::string help = kerfbench("--help").output;
  const auto show = help.find("\n  show "), calibrate = help.find("\n  calibrate "),
             gauge = help.find("\n  gauge ");
  ASSERT_NE(gauge, std::string::npos) << help;
  EXPECT_LT(show, calibrate);
  EXPECT_LT(calibrate, gauge);
  EXPECT_EQ(program("kerfbench-instrument", "--help").output,
            help.substr(0, help.find("\n  run ")) + help.substr(calibrate));
}

TEST(InstrumentCommands, AnswerAsThoseOfOneProgram) {
  EXPECT_THAT(kerfbench("gauge --help").output, HasSubstr("Usage: kerfbench gauge [OPTIONS]"));
  EXPECT_EQ(kerfbench("--help calibrate").output, kerfbench("calibrate --help").output);
  EXPECT_EQ(kerfbench("--version gauge").output, kerfbench("--version").output);
  EXPECT_EQ(kerfbench("calibrate").exit_code, 64);
  EXPECT_EQ(kerfbench("calibrate run").exit_code, 64);
  EXPECT_EQ(kerfbench("'' calibrate").output, kerfbench("calibrate").output);
  const ProgramRun misspelt = kerfbench("gaueg");
  EXPECT_EQ(misspelt.exit_code, 64);
  EXPECT_THAT(misspelt.output, HasSubstr("there is no command 'gaueg'. Did you mean gauge?"));
}

TEST(InstrumentCommands, SayWhichProgramIsNotBuilt) {
  const ScratchFolder alone;
  std::filesystem::copy_file(std::filesystem::path(KERFBENCH_BINARY_DIR) / "bin/kerfbench",
                             alone.path() / "kerfbench");
  const ProgramRun run = program((alone.path() / "kerfbench").string(), "calibrate target --help");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(
      run.output,
      "kerfbench calibrate is in kerfbench-instrument, which is not built: ./bench calibrate builds it\n");
}

}  // namespace
}  // namespace kerfbench::test

// SPDX-License-Identifier: Apache-2.0
// What stands beside `calibrate head`: sheets cut by hand, the quick check, the reversal.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kWaiting = 75;

/// A head that was calibrated on the twin, with all pictures, once for all tests.
class HeadTools : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = std::make_unique<ScratchFolder>();
    const ProgramRun run = kerfbench(fmt::format("calibrate head {} --keep-pictures --results-dir '{}'",
                                                 options(), calibrated().string()));
    ASSERT_EQ(run.exit_code, 0) << run.output;
  }
  static void TearDownTestSuite() { shared_.reset(); }

  static std::string options() {
    return fmt::format("--machine '{}' --seed 2 --grids 3,5 --verify 20",
                       fixture("machines/two-mirror-100.yaml").string());
  }
  static fs::path calibrated() { return shared_->path() / "calibrated"; }

  [[nodiscard]] fs::path path(const std::string& name) const { return scratch_.path() / name; }

  static std::unique_ptr<ScratchFolder> shared_;
  ScratchFolder scratch_;
};
std::unique_ptr<ScratchFolder> HeadTools::shared_;

TEST_F(HeadTools, ByHandTheSameSheetsGiveTheSameTable) {
  const fs::path by_hand = path("by-hand");
  const auto run = [&] {
    return kerfbench(
        fmt::format("calibrate head {} --by-hand --results-dir '{}'", options(), by_hand.string()));
  };
  ProgramRun last = run();
  int sheets = 0;
  for (; last.exit_code == kWaiting && sheets < 10; ++sheets) {
    // The sheet that waits is the one without pictures.
    for (const auto& sheet : fs::directory_iterator(by_hand)) {
      if (!sheet.is_directory() || fs::exists(sheet.path() / "pictures")) continue;
      const std::string name = sheet.path().filename().string();
      SCOPED_TRACE(name);
      EXPECT_THAT(last.output, HasSubstr(name + ": a sheet is to be cut"));
      EXPECT_THAT(last.output, HasSubstr("Run again: ./bench calibrate head"));
      for (const char* file : {"NEXT.txt", "marks.dxf", "job.gcode", "program.txt", "print.svg", "run.yaml"})
        EXPECT_FALSE(textOf(sheet.path() / file).empty()) << file;
      EXPECT_EQ(fs::exists(sheet.path() / "table.csv"), name != "1-grid");
      // Whoever cuts gets the very job that the twin got.
      ASSERT_EQ(textOf(sheet.path() / "marks.yaml"), textOf(calibrated() / name / "marks.yaml"));
      fs::copy(calibrated() / name / "pictures", sheet.path() / "pictures");
    }
    last = run();
  }
  EXPECT_EQ(last.exit_code, 0) << last.output;
  EXPECT_GE(sheets, 2);
  EXPECT_EQ(textOf(by_hand / "correction.csv"), textOf(calibrated() / "correction.csv"));
}

TEST_F(HeadTools, ByHandTellsWrongPicturesAndWritesNoTable) {
  const std::string command =
      fmt::format("calibrate head {} --by-hand --results-dir '{}'", options(), path("by-hand").string());
  EXPECT_EQ(kerfbench(command).exit_code, kWaiting);
  fs::copy(calibrated() / "1-verify/pictures", path("by-hand/1-grid/pictures"));
  const ProgramRun wrong = kerfbench(command);
  EXPECT_EQ(wrong.exit_code, 3) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("another job's sheet"));
  // The right ones in their place are taken.
  fs::remove_all(path("by-hand/1-grid/pictures"));
  fs::copy(calibrated() / "1-grid/pictures", path("by-hand/1-grid/pictures"));
  const ProgramRun right = kerfbench(command);
  EXPECT_EQ(right.exit_code, kWaiting) << right.output;
  EXPECT_THAT(right.output, HasSubstr("1-verify: a sheet is to be cut"));
}

TEST_F(HeadTools, ByHandForAnAvrControllerItsProgramIsPlanned) {
  const auto periods = [&](const char* image) {
    const ProgramRun run = kerfbench(fmt::format("calibrate head {} --by-hand {} --results-dir '{}' -q",
                                                 options(), image, path("avr").string()));
    EXPECT_EQ(run.exit_code, kWaiting) << run.output;
    const std::string program = textOf(path("avr/1-grid/program.txt"));
    EXPECT_EQ(program.rfind("config ", 0), 0U);
    return std::ranges::count(program, '\n');
  };
  const auto galvo = periods("");
  EXPECT_NE(periods("--image controller-avr.hex"), galvo);
  EXPECT_EQ(kerfbench(fmt::format("calibrate head {} --by-hand --image none.hex --results-dir '{}'",
                                  options(), path("none").string()))
                .exit_code,
            65);
}

}  // namespace
}  // namespace kerfbench::test

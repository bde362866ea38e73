// SPDX-License-Identifier: Apache-2.0
// Command `calibrate table`: kind and orientation of a correction file, and its conversion to other formats.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "hil/calibrate/tables/recognise.h"
#include "hil/calibrate/tables/table_files.h"
#include "tests/hil/calibrate/tables/seeded_head.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using calibrate::AimGrid;
using calibrate::TableFormat;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kHalf_mm = 50.0;
constexpr double kMmPerIndex = 2.5;

class CalibrateTable : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  /// Writes a table, and runs the command on it.
  [[nodiscard]] ProgramRun table(const std::string& arguments) const {
    return kerfbench("calibrate table " + arguments);
  }
  std::string written(const AimGrid& grid, const std::string& name,
                      TableFormat format = TableFormat::kCsv) const {
    calibrate::writeTable(path(name), format, grid, {});
    return path(name);
  }
  /// Nine marks without correction, measured by hand to 10 µm.
  [[nodiscard]] std::string nineMarks(const calibrate::SeededHead& head) const {
    std::string text = fmt::format("# mm_per_index: {}\n", kMmPerIndex);
    for (const calibrate::UncorrectedSpot& spot : head.nineSpots(0.01, 5)) {
      const Eigen::Vector2d wrong = spot.spot_W_mm - spot.aim_W_mm;
      text += fmt::format("{:.0f} {:.0f} {:.3f} {:.3f}\n", spot.aim_W_mm.x() / kMmPerIndex,
                          spot.aim_W_mm.y() / kMmPerIndex, wrong.x(), wrong.y());
    }
    return file("nine.txt", text);
  }
  [[nodiscard]] std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  [[nodiscard]] double apart_um(const std::string& name) const {
    return calibrate::tableLoss(grid_, calibrate::readTable(path(name))).anywhere.max_um;
  }

  ScratchFolder scratch_;
  calibrate::SeededHead head_{8, kHalf_mm};
  AimGrid grid_{
      head_.table(calibrate::evenly(-kHalf_mm, kHalf_mm, 33), calibrate::evenly(-kHalf_mm, kHalf_mm, 33))};
};

TEST_F(CalibrateTable, TellsWhatAFileIs) {
  const ProgramRun run = table(written(grid_, "t.csv"));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("t.csv: csv\n"));
  EXPECT_THAT(run.output, HasSubstr("added to the aim; bicubic Hermite between nodes; outside refused"));
  EXPECT_THAT(run.output, HasSubstr("33 x 33, x -50.0000 … 50.0000 mm"));
  EXPECT_THAT(run.output, HasSubstr("would tell it from all readings that are another table"));

  // Corrections of a few µm are too small for nine marks.
  const AimGrid small = calibrate::SeededHead(8, kHalf_mm, 0.03)
                            .table(calibrate::evenly(-50, 50, 9), calibrate::evenly(-50, 50, 9));
  EXPECT_THAT(table(written(small, "small.csv")).output, HasSubstr("too symmetrical, or too small"));
}

/// Rule in the output, "bilinear between nodes; outside linear", around the place `at`.
std::string ruleSaidAt(const std::string& said, std::size_t at) {
  const std::size_t begin = said.rfind("; ", at) + 2;
  return said.substr(begin, said.find('\n', at) - begin);
}

TEST_F(CalibrateTable, EachFormatBecomesEachOtherAndTheLossIsTold) {
  const std::string csv = written(grid_, "t.csv");
  for (const std::string to : {"c-header", "cor1", "cor2", "grid-text", "nine-points"}) {
    const ProgramRun there = table(fmt::format("{} --to {} --out {}", csv, to, path("t." + to)));
    EXPECT_EQ(there.exit_code, 0) << there.output;
    EXPECT_THAT(there.output, HasSubstr("middles of cells: "));
    EXPECT_THAT(there.output, HasSubstr("rim: "));
    const ProgramRun back = table(fmt::format("{} --out {}", path("t." + to), path("back." + to)));
    EXPECT_EQ(back.exit_code, 0) << back.output;
    EXPECT_THAT(back.output, HasSubstr(fmt::format("t.{0}: {0}\n", to)));
    // The output about a file is the same when it is written and when it is read.
    const std::size_t written_at = there.output.rfind(" between nodes");
    const std::size_t read_at = back.output.find(" between nodes");
    ASSERT_NE(written_at, std::string::npos);
    ASSERT_NE(read_at, std::string::npos);
    EXPECT_EQ(ruleSaidAt(there.output, written_at), ruleSaidAt(back.output, read_at)) << to;
    // The tolerance is for bilinear between 33 x 33 nodes: 2 µm of a few mm; a quadratic through nine points:
    // 200.
    EXPECT_LT(apart_um("back." + to), to == "nine-points" ? 1000.0 : to == "grid-text" ? 10.0 : 2.0) << to;
  }
  const ProgramRun coarse = table(fmt::format("{} --nodes 5x5 --out {}", csv, path("coarse.csv")));
  EXPECT_THAT(coarse.output, HasSubstr("of 25 places"));
  EXPECT_GT(apart_um("coarse.csv"), 1e-3);
}

TEST_F(CalibrateTable, AForeignTableReadTheWrongWayRoundIsRecognisedAndRighted) {
  const std::string nine = nineMarks(head_);
  // The program reads the file in another orientation than its author meant.
  const auto foreign = [&](const Eigen::Matrix2i& map, int sign, const std::string& name) {
    return written(calibrate::asRead(grid_, {map, sign * map}), name + ".csv");
  };
  Eigen::Matrix2i transposed, mirrored;
  transposed << 0, 1, 1, 0;
  mirrored << -1, 0, 0, 1;
  struct Case {
    std::string file, words;
  };
  const std::vector<Case> cases{
      {foreign(transposed, 1, "transposed"), "the file is transposed"},
      {foreign(mirrored, 1, "mirrored"), "the file is mirrored in x"},
      {foreign(Eigen::Matrix2i::Identity(), -1, "flipped"), "the sign is turned"},
      {foreign(transposed, -1, "both"), "the file is transposed, and its sign is turned"},
  };
  for (const Case& one : cases) {
    const ProgramRun told = table(fmt::format("{} --check {} -q", one.file, nine));
    EXPECT_EQ(told.exit_code, 1) << told.output;
    EXPECT_THAT(told.output, HasSubstr(one.words + ": "));
    const ProgramRun righted =
        table(fmt::format("{} --check {} --out {}", one.file, nine, path("righted.csv")));
    EXPECT_EQ(righted.exit_code, 0) << righted.output;
    EXPECT_THAT(righted.output, HasSubstr("righted.csv: csv, righted"));
    EXPECT_LT(apart_um("righted.csv"), 1e-6);
  }
  const ProgramRun good = table(fmt::format("{} --check {} -q", written(grid_, "good.csv"), nine));
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_THAT(good.output, HasSubstr("the file is as it was read"));
}

TEST_F(CalibrateTable, AForeignConventionOfCorFilesIsRecognised) {
  calibrate::TableOptions meerk40t;
  meerk40t.cor = calibrate::CorConvention::meerk40t();
  meerk40t.cor.units_per_mm = 655.36;
  calibrate::writeTable(path("t.cor"), TableFormat::kCor2, grid_, meerk40t);
  const std::string nine = nineMarks(head_);
  const ProgramRun as_glase = table(fmt::format("{} --check {}", path("t.cor"), nine));
  EXPECT_EQ(as_glase.exit_code, 1) << as_glase.output;
  EXPECT_THAT(as_glase.output, HasSubstr("the file is transposed"));
  const ProgramRun as_meant = table(fmt::format("{} --cor meerk40t --check {}", path("t.cor"), nine));
  EXPECT_EQ(as_meant.exit_code, 0) << as_meant.output;
}

TEST_F(CalibrateTable, WhatTheMarksDoNotBearOutIsNotWritten) {
  const std::string out = file("out.csv", "old");
  const ProgramRun other = table(fmt::format("{} --check {} --out {}", written(grid_, "t.csv"),
                                             nineMarks(calibrate::SeededHead(9, kHalf_mm)), out));
  EXPECT_EQ(other.exit_code, 1) << other.output;
  EXPECT_THAT(other.output, HasSubstr("no reading fits"));
  EXPECT_EQ(textOf(out), "old");

  // A barrel alone equals its transpose; but nine marks do not distinguish a mirrored one from a sign within
  // 1 mm.
  const ProgramRun rough =
      table(fmt::format("{} --check {} --sigma-mm 1 --out {}", path("t.csv"), nineMarks(head_), out));
  EXPECT_EQ(rough.exit_code, 4) << rough.output;
  EXPECT_THAT(rough.output, HasSubstr("cannot be told"));
  EXPECT_EQ(textOf(out), "old");
}

TEST_F(CalibrateTable, TellsEverythingThatIsWrongWithItsInput) {
  const ProgramRun bad = table(file("bad.csv", "x_mm,y_mm,dx_mm,dy_mm\n0,0,0,zero\n1,0,nan,0\n2,0,0\n"));
  EXPECT_EQ(bad.exit_code, 65);
  for (const char* line : {"bad.csv:2: ", "bad.csv:3: ", "bad.csv:4: "})
    EXPECT_THAT(bad.output, HasSubstr(line));
  EXPECT_THAT(table(path("none.csv")).output, HasSubstr("none.csv: no such file"));
  EXPECT_THAT(table(file("what.txt", "hello\n")).output, HasSubstr("cannot be told from its content"));

  const std::string csv = written(grid_, "t.csv");
  const std::string out = file("out.h", "old");
  const ProgramRun large = table(fmt::format("{} --to c-header --nodes 200x200 --out {}", csv, out));
  EXPECT_EQ(large.exit_code, 65) << large.output;
  EXPECT_THAT(large.output, HasSubstr("80000 bytes"));
  EXPECT_EQ(textOf(out), "old");

  EXPECT_EQ(table(csv + " --nodes 5 --out " + out).exit_code, 64);
  EXPECT_EQ(table(csv + " --to cor3 --out " + out).exit_code, 64);
  EXPECT_EQ(table(csv + " --to cor1").exit_code, 64);
}

}  // namespace
}  // namespace kerfbench::test

// SPDX-License-Identifier: Apache-2.0
// Command `calibrate head`, from marks that are cut to a table that is verified, by pictures.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class CalibrateHead : public testing::Test {
 protected:
  [[nodiscard]] ProgramRun calibrate(const std::string& options) const {
    return kerfbench(fmt::format("calibrate head --machine '{}' --seed 2 --grids 3,5 --verify 20 {}",
                                 fixture("machines/two-mirror-100.yaml").string(), options));
  }
  [[nodiscard]] std::string results(const std::string& name) const {
    return (scratch_.path() / name).string();
  }
  /// A table in use.
  [[nodiscard]] fs::path oldTable() const {
    std::ofstream(scratch_.path() / "old.csv") << "old";
    return scratch_.path() / "old.csv";
  }
  ScratchFolder scratch_;
};

TEST_F(CalibrateHead, TakesAMountedHeadOffByMillimetresToMicrometresAndGoesOnFromWhatIsThere) {
  const std::string live = fmt::format("--results-dir '{}' --keep-pictures", results("live"));
  const ProgramRun run = calibrate(live);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::string json = textOf(scratch_.path() / "live/head.json");
  const auto head = nlohmann::json::parse(json);
  const auto& last = head.at("iterations").back();
  EXPECT_TRUE(head.at("good"));
  EXPECT_GT(head.at("iterations").front().at("before").at("max_mm"), 1.0);
  EXPECT_EQ(last.at("after").at("marks"), 20);
  EXPECT_LT(last.at("after").at("max_mm"), 0.010);
  EXPECT_GT(last.at("after").at("max_mm"), 0.0);
  EXPECT_GE(last.at("within_stated_95"), 17);  // At 95 % there is a chance of 2 % for fewer.
  const std::string table = textOf(scratch_.path() / "live/correction.csv");
  EXPECT_THAT(table, HasSubstr("x_mm,y_mm,dx_mm,dy_mm"));
  const std::string page = textOf(scratch_.path() / "live/report.html");
  EXPECT_THAT(page, HasSubstr("<div class=big>GOOD</div>"));
  for (const char* file : {"correction.csv", "correction-1.csv", "1-grid/", "1-verify-1/", "head.json"}) {
    EXPECT_THAT(page, HasSubstr(fmt::format("href='{}'", file)));
    EXPECT_TRUE(fs::exists(scratch_.path() / "live" / file)) << file;
  }

  const ProgramRun again = calibrate(live);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, HasSubstr("1-grid: measured before"));
  EXPECT_EQ(textOf(scratch_.path() / "live/head.json"), json);

  // The table is good, but not for this limit; the table that it should replace stays.
  const fs::path old = oldTable();
  const ProgramRun strict = calibrate(live + fmt::format(" --limit-mm 0.0001 --out '{}'", old.string()));
  EXPECT_EQ(strict.exit_code, 1) << strict.output;
  EXPECT_EQ(textOf(old), "old");

  // The same pictures give the same table; those of another sheet are recognised.
  const fs::path sheets = scratch_.path() / "live";
  const auto pictures = [&](const char* sheet) {
    return calibrate(fmt::format("--job '{}' --pictures '{}' --results-dir '{}' --out '{}'",
                                 (sheets / "1-grid/marks.yaml").string(),
                                 (sheets / sheet / "pictures").string(), results("pictures"), old.string()));
  };
  const ProgramRun wrong = pictures("1-verify-1");
  EXPECT_EQ(wrong.exit_code, 3) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("another job's sheet"));
  EXPECT_EQ(textOf(old), "old");
  // Nine marks alone prove no table to be within this limit; for a wider one they do.
  const ProgramRun from_pictures = pictures("1-grid");
  EXPECT_THAT(from_pictures.exit_code, testing::AnyOf(1, 4)) << from_pictures.output;
  EXPECT_EQ(textOf(old), "old");
  EXPECT_EQ(textOf(scratch_.path() / "pictures/correction-1.csv"), textOf(sheets / "correction-1.csv"));
  const ProgramRun wide = kerfbench(fmt::format(
      "calibrate head --machine '{}' --job '{}' --pictures '{}' --results-dir '{}' --out '{}' --limit-mm 0.1",
      fixture("machines/two-mirror-100.yaml").string(), (sheets / "1-grid/marks.yaml").string(),
      (sheets / "1-grid/pictures").string(), results("pictures"), old.string()));
  EXPECT_EQ(wide.exit_code, 0) << wide.output;
  EXPECT_THAT(wide.output, HasSubstr("NOT VERIFIED"));
  EXPECT_EQ(textOf(old), textOf(sheets / "correction-1.csv"));
}

// Told of a light of 235, marks under one of 150 cannot be read.
TEST_F(CalibrateHead, LooksForMarksByTheLightThatTheMachineFileTells) {
  std::ofstream(scratch_.path() / "dim.yaml")
      << fmt::format("extends: '{}'\nname: dim\ncameras: {{kerf: {{open_gray: 150}}}}\n",
                     fixture("machines/two-mirror-mounted.yaml").string());
  const ProgramRun run =
      kerfbench(fmt::format("calibrate head --machine '{}' --seed 1 --grids 3 --verify 20 --results-dir '{}'",
                            (scratch_.path() / "dim.yaml").string(), results("dim")));
  EXPECT_EQ(run.exit_code, 0) << run.output;
}

TEST_F(CalibrateHead, ToldWhatIsWrongWithItsInput) {
  const ProgramRun gantry =
      kerfbench(fmt::format("calibrate head --machine '{}' --results-dir '{}'",
                            fixture("machines/strip-gantry.yaml").string(), results("g")));
  EXPECT_EQ(gantry.exit_code, 65);
  EXPECT_THAT(gantry.output, HasSubstr("has no scan head"));
  const ProgramRun dense =
      kerfbench(fmt::format("calibrate head --machine '{}' --grids 33 --results-dir '{}'",
                            fixture("machines/two-mirror-100.yaml").string(), results("d")));
  EXPECT_EQ(dense.exit_code, 65);
  EXPECT_THAT(dense.output, HasSubstr("are too near for a kerf"));
  EXPECT_EQ(calibrate("--pictures there").exit_code, 64);
}

}  // namespace
}  // namespace kerfbench::test

// SPDX-License-Identifier: Apache-2.0
// Command `calibrate`, and the verdict of a run without a good calibration.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Calibration : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name) << text;
    return scratch_.path() / name;
  }
  /// The two-mirror machine (with another house's controller) and these lines.
  fs::path machine(const std::string& lines) const {
    return write("m.yaml", "extends: " + fixture("machines/two-mirror-linecutter.yaml").string() +
                               "\nname: m\n" + lines);
  }
  /// Cuts the plate at rest on that machine.
  ProgramRun plate(const std::string& machine_lines, const std::string& scenario_lines = "") const {
    const auto path = write("plate.yaml", "extends: " + fixture("scenarios/line-ok/plate.yaml").string() +
                                              "\nname: plate\nmachine: " + machine(machine_lines).string() +
                                              "\n" + scenario_lines);
    return kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}'", path.string(),
                                 (scratch_.path() / "results").string()));
  }
  void expectInvalid(const ProgramRun& run, const std::string& why) const {
    EXPECT_EQ(run.exit_code, 3) << run.output;
    EXPECT_THAT(run.output, HasSubstr(why));
    EXPECT_THAT(run.output, HasSubstr("run: ./bench calibrate camera --machine"));
    const auto verdict = verdictOf(scratch_.path() / "results" / "plate");
    EXPECT_EQ(verdict.at("verdict"), "INVALID");
    for (const auto& check : verdict.at("checks"))
      EXPECT_TRUE(check.at("name") != "path" || check.at("verdict") != "PASS") << check;
  }
  /// A kerf camera of few pixels: quick to calibrate.
  static std::string smallKerf() {
    return "cameras: {kerf: {size_px: [560, 440], pitch_mm: 0.1, height_mm: 250, tilt_deg: 2, id: little, "
           "calibration: little.yaml}}\n";
  }
  ProgramRun calibrate(const std::string& options) const {
    return kerfbench(fmt::format("calibrate camera --residual-map '{}' {}",
                                 (scratch_.path() / "residuals.svg").string(), options));
  }
  ScratchFolder scratch_;
};

TEST_F(Calibration, MissingMakesARunInvalid) {
  expectInvalid(plate("cameras: {kerf: {calibration: none.yaml}}\n"), "none.yaml is missing");
}

TEST_F(Calibration, StaleMakesARunInvalid) {
  expectInvalid(plate("", "date: 2027-11-20\n"), "is stale: of 2026-11-20, 365 days before the run's date");
  expectInvalid(plate("cameras: {spot: {tilt_deg: 3.5}}\n"),
                "is stale: the machine file describes another lens");
}

TEST_F(Calibration, OfAnotherCameraMakesARunInvalid) {
  const auto other = fixture("machines/strip-gantry.spot.camera.yaml").string();
  expectInvalid(plate("cameras: {spot: {calibration: " + other + "}}\n"),
                "is of another camera: 'strip-gantry-spot', not 'two-mirror-spot'");
}

TEST_F(Calibration, FromFilesIsThatFromTheTwinThatMadeThem) {
  const auto file = machine(smallKerf());
  const std::string which = fmt::format("--machine '{}' --camera kerf --date 2026-10-01", file.string());
  const auto views = scratch_.path() / "views";
  const auto twin = calibrate(fmt::format("{} --seed 5 --tilted 4 --save-views '{}'", which, views.string()));
  ASSERT_EQ(twin.exit_code, 0) << twin.output;
  EXPECT_THAT(twin.output, HasSubstr("little: residual 0.00"));
  const std::string by_twin = textOf(scratch_.path() / "little.yaml");
  EXPECT_THAT(by_twin,
              HasSubstr("kerfbench calibrate camera --machine m.yaml --camera kerf --date 2026-10-01 "
                        "--seed 5 --tilted 4"));
  EXPECT_THAT(textOf(scratch_.path() / "residuals.svg"), HasSubstr("Camera little, 2026-10-01"));

  std::smatch place;
  ASSERT_TRUE(std::regex_search(twin.output, place, std::regex("--origin-mm \\S+ \\S+ --turn-deg \\S+")));
  const auto files = calibrate(fmt::format("{} --views '{}' --target '{}' {} --out '{}'", which,
                                           views.string(), (views / "target.yaml").string(), place.str(),
                                           (scratch_.path() / "files.yaml").string()));
  ASSERT_EQ(files.exit_code, 0) << files.output;
  const std::string by_files = textOf(scratch_.path() / "files.yaml");
  EXPECT_EQ(by_files.substr(by_files.find("version:")), by_twin.substr(by_twin.find("version:")));
  EXPECT_THAT(files.output, HasSubstr("the machine file looks for"));
}

TEST_F(Calibration, RefusedViewsLeaveNothingBehind) {
  const auto file = machine(smallKerf());
  const std::string which = fmt::format("--machine '{}' --camera kerf --date 2026-10-01", file.string());
  const auto none = calibrate(which + " --views '" + write("a.png", "no picture").string() + "' '" +
                              (scratch_.path() / "b.png").string() + "'");
  EXPECT_EQ(none.exit_code, 65);
  for (const char* part : {"2 views are too few", "a.png: is no picture that can be read",
                           "b.png: no such file", "no calibration is written"})
    EXPECT_THAT(none.output, HasSubstr(part));
  const auto strict = calibrate(which + " --tilted 3 --max-rms-px 0.0005");
  EXPECT_EQ(strict.exit_code, 65);
  EXPECT_THAT(strict.output, HasSubstr("at most 0.0005"));
  EXPECT_EQ(calibrate("--machine '" + file.string() + "' --camera kerf --date soon --tilted 3").exit_code,
            65);
  EXPECT_FALSE(fs::exists(scratch_.path() / "little.yaml"));
  EXPECT_FALSE(fs::exists(scratch_.path() / "residuals.svg"));
  EXPECT_EQ(calibrate("--camera kerf --date 2026-10-01").exit_code, 64);
  EXPECT_EQ(calibrate(which + " --camera third").exit_code, 64);
  EXPECT_EQ(kerfbench("calibrate").exit_code, 64);
}

TEST_F(Calibration, AnInheritedFileIsNotOverwritten) {
  // The spot camera was moved, but the key still names the file of the machine that is extended.
  const auto file = machine("cameras: {kerf: {size_px: [560, 440], pitch_mm: 0.1, height_mm: 250}}\n");
  const auto before = textOf(fixture("machines/two-mirror.kerf.camera.yaml"));
  const auto run =
      calibrate(fmt::format("--machine '{}' --camera kerf --date 2026-10-01 --tilted 3", file.string()));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(fs::exists(scratch_.path() / "m.kerf.camera.yaml"));
  EXPECT_EQ(textOf(fixture("machines/two-mirror.kerf.camera.yaml")), before);
  EXPECT_THAT(run.output, HasSubstr("give it cameras: {kerf: {calibration: m.kerf.camera.yaml}}"));
}

TEST_F(Calibration, LintWarnsOfACameraWithoutOneAndReadsThoseThatAre) {
  const auto run =
      kerfbench("lint '" + machine("cameras: {kerf: {calibration: none.yaml}}\n").string() + "'");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("warning: kerf camera: its calibration"));
  std::string text = textOf(fixture("machines/two-mirror.kerf.camera.yaml"));
  EXPECT_EQ(kerfbench("lint '" + write("c.yaml", text).string() + "'").exit_code, 0);
  const auto bad = kerfbench("lint '" + write("c.yaml", text + "more: 1\n").string() + "'");
  EXPECT_EQ(bad.exit_code, 65);
  EXPECT_THAT(bad.output, HasSubstr("more: unknown key"));
}

TEST_F(Calibration, ATargetToPrintComesWithItsDescription) {
  const auto svg = scratch_.path() / "target.svg";
  const auto run = kerfbench(fmt::format("calibrate target --out '{}' --machine '{}' --camera spot",
                                         svg.string(), fixture("machines/two-mirror.yaml").string()));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(textOf(svg), HasSubstr("42 x 42 squares of 5 mm"));
  EXPECT_THAT(textOf(scratch_.path() / "target.yaml"), HasSubstr("columns: 42"));
  EXPECT_EQ(kerfbench(fmt::format("calibrate target --out '{}'", svg.string())).exit_code, 65);
  EXPECT_EQ(
      kerfbench(fmt::format("calibrate target --out '{}' --columns 60 --rows 60 --square-mm 2", svg.string()))
          .exit_code,
      65);
}

}  // namespace
}  // namespace kerfbench::test

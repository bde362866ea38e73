// SPDX-License-Identifier: Apache-2.0
// Tools of `calibrate head`: sheets cut by hand, the quick check, the reversal.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
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
    // The waiting sheet is the one without pictures.
    for (const auto& sheet : fs::directory_iterator(by_hand)) {
      if (!sheet.is_directory() || fs::exists(sheet.path() / "measured.yaml")) continue;
      const std::string name = sheet.path().filename().string();
      SCOPED_TRACE(name);
      EXPECT_THAT(last.output, HasSubstr(name + ": a sheet is to be cut"));
      EXPECT_THAT(last.output, HasSubstr("Run again: ./bench calibrate head"));
      for (const char* file : {"NEXT.txt", "marks.dxf", "job.gcode", "program.txt", "print.svg", "print.pdf",
                               "run.yaml", "pictures/tiles.yaml", "pictures/scan.yaml"})
        EXPECT_FALSE(textOf(sheet.path() / file).empty()) << file;
      EXPECT_EQ(fs::exists(sheet.path() / "table.csv"), name != "1-grid");
      // The operator gets the very job that the twin got.
      ASSERT_EQ(textOf(sheet.path() / "marks.yaml"), textOf(calibrated() / name / "marks.yaml"));
      fs::copy(calibrated() / name / "pictures", sheet.path() / "pictures",
               fs::copy_options::overwrite_existing | fs::copy_options::recursive);
      const auto steps = nlohmann::json::parse(textOf(by_hand / "steps.json"));
      EXPECT_EQ(steps.at("headline"), fmt::format("Cut sheet {}: {} marks", name,
                                                  name == "1-grid"   ? 9
                                                  : name == "2-grid" ? 25
                                                                     : 20));
      EXPECT_EQ(steps.at("verdict"), "");
    }
    last = run();
  }
  EXPECT_EQ(last.exit_code, 0) << last.output;
  EXPECT_GE(sheets, 2);
  EXPECT_EQ(textOf(by_hand / "correction.csv"), textOf(calibrated() / "correction.csv"));
  const auto steps = nlohmann::json::parse(textOf(by_hand / "steps.json"));
  EXPECT_EQ(steps.at("verdict"), "GOOD");
  EXPECT_EQ(steps.at("steps").back().at("id"), "controller");
  EXPECT_EQ(steps.at("steps").back().at("state"), "now");
  EXPECT_THAT(textOf(by_hand / "steps.html"), HasSubstr("<div class=big>GOOD</div>"));
}

TEST_F(HeadTools, ByHandTellsWrongPicturesAndWritesNoTable) {
  const std::string command =
      fmt::format("calibrate head {} --by-hand --results-dir '{}'", options(), path("by-hand").string());
  EXPECT_EQ(kerfbench(command).exit_code, kWaiting);
  fs::copy_file(calibrated() / "1-verify-1/pictures/tile-0000.png",
                path("by-hand/1-grid/pictures/tile-0000.png"));
  const ProgramRun some = kerfbench(command);
  EXPECT_EQ(some.exit_code, kWaiting) << some.output;
  EXPECT_THAT(some.output, HasSubstr("are missing: tile-0001.png, "));
  fs::remove_all(path("by-hand/1-grid/pictures"));
  fs::copy(calibrated() / "1-verify-1/pictures", path("by-hand/1-grid/pictures"));
  const ProgramRun wrong = kerfbench(command);
  EXPECT_EQ(wrong.exit_code, 3) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("another job's sheet"));
  const auto steps = nlohmann::json::parse(textOf(path("by-hand/steps.json"))).at("steps");
  EXPECT_THAT(steps.at(3).at("wrong").dump(), HasSubstr("another job's sheet"));
  // The right pictures in their place are accepted.
  fs::remove_all(path("by-hand/1-grid/pictures"));
  fs::copy(calibrated() / "1-grid/pictures", path("by-hand/1-grid/pictures"));
  const ProgramRun right = kerfbench(command);
  EXPECT_EQ(right.exit_code, kWaiting) << right.output;
  EXPECT_THAT(right.output, HasSubstr("1-verify-1: a sheet is to be cut"));
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

struct Drift {
  const char* now;  ///< Later lines of the machine's file.
  const char* what;
  double value;
};

TEST_F(HeadTools, TheQuickCheckSaysWhatHasDriftedAndByHowMuch) {
  // The beam turns by 160 µrad for 80 µrad of a mirror, at 125 mm (X) and 110 mm (Y).
  const std::vector<Drift> drifts{{"optics: {mirror_x: {zero_urad: 80}}", "zero of x", 2 * 80e-6 * 125},
                                  {"optics: {mirror_y: {zero_urad: -80}}", "zero of y", -2 * 80e-6 * 110},
                                  {"optics: {mirror_x: {scale: 1.0004}}", "gain of x", 0.0004},
                                  {"optics: {mirror_y: {scale: 0.9996}}", "gain of y", -0.0004},
                                  {"surface: {height_mm: 0.2}", "sheet height", 0.2}};
  for (const Drift& drift : drifts) {
    std::ofstream(path("drifted.yaml"))
        << fmt::format("extends: '{}'\nname: two-mirror-100\n{}\n",
                       fixture("machines/two-mirror-100.yaml").string(), drift.now);
    const ProgramRun run =
        kerfbench(fmt::format("calibrate check --machine '{}' --seed 2 --calibration '{}' --results-dir '{}'",
                              path("drifted.yaml").string(), calibrated().string(), path("check").string()));
    SCOPED_TRACE(run.output);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.output, HasSubstr(fmt::format("{} changed by", drift.what)));
    const auto check = nlohmann::json::parse(textOf(path("check/check.json")));
    EXPECT_FALSE(check.at("holds"));
    EXPECT_FALSE(check.at("unexplained"));
    for (const auto& found : check.at("drifts")) {
      const double sigma = found.at("sigma");
      EXPECT_GT(sigma, 0.0);
      const bool this_one = found.at("name") == drift.what;
      EXPECT_NEAR(found.at("value"), this_one ? drift.value : 0.0, 4 * sigma + 0.02 * std::abs(drift.value))
          << found.at("name");
      EXPECT_TRUE(found.at("changed") || !this_one);
    }
  }
}

TEST_F(HeadTools, AnUnchangedHeadHoldsOnTheTwinFromPicturesAndByHand) {
  const auto check = [&](const std::string& options) {
    return kerfbench(fmt::format("calibrate check --machine '{}' --seed 2 --calibration '{}' {}",
                                 fixture("machines/two-mirror-100.yaml").string(), calibrated().string(),
                                 options));
  };
  const ProgramRun live = check(fmt::format("--results-dir '{}' --keep-pictures -q", path("live").string()));
  EXPECT_EQ(live.exit_code, 0) << live.output;
  EXPECT_THAT(live.output, HasSubstr("the correction holds"));
  const fs::path sheet = path("live/check");
  const ProgramRun pictures =
      check(fmt::format("--job '{}' --pictures '{}' --results-dir '{}' -q", (sheet / "marks.yaml").string(),
                        (sheet / "pictures").string(), path("pictures").string()));
  EXPECT_EQ(pictures.exit_code, 0) << pictures.output;
  EXPECT_EQ(pictures.output, live.output);

  const std::string by_hand = fmt::format("--by-hand --results-dir '{}' -q", path("by-hand").string());
  EXPECT_EQ(check(by_hand).exit_code, kWaiting);
  EXPECT_EQ(textOf(path("by-hand/check/marks.yaml")), textOf(sheet / "marks.yaml"));
  EXPECT_EQ(textOf(path("by-hand/check/table.csv")), textOf(calibrated() / "correction.csv"));
  fs::copy(sheet / "pictures", path("by-hand/check/pictures"),
           fs::copy_options::overwrite_existing | fs::copy_options::recursive);
  EXPECT_EQ(check(by_hand).output, live.output);
  EXPECT_EQ(nlohmann::json::parse(textOf(path("by-hand/steps.json"))).at("verdict"), "HOLDS");

  // Checks of other days make a trend.
  for (const char* day : {"2026-12-24", "2027-01-21"})
    EXPECT_EQ(check(fmt::format("--results-dir '{}' --date {} -q", path("live").string(), day)).exit_code, 0);
  const std::string kept = textOf(path("live/checks.jsonl"));
  EXPECT_EQ(std::ranges::count(kept, '\n'), 3);
  EXPECT_THAT(textOf(path("live/check.html")), HasSubstr("no drift is proven"));
  EXPECT_EQ(check(fmt::format("--results-dir '{}' --date 2027-01-21 -q", path("live").string())).exit_code,
            0);
  EXPECT_EQ(textOf(path("live/checks.jsonl")), kept);

  const ProgramRun wrong =
      check(fmt::format("--job '{}' --pictures '{}' --results-dir '{}'", (sheet / "marks.yaml").string(),
                        (calibrated() / "1-verify-1/pictures").string(), path("wrong").string()));
  EXPECT_EQ(wrong.exit_code, 3) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("INVALID: nothing is said of the head"));
}

TEST_F(HeadTools, TheQuickCheckRefusesACalibrationThatIsNone) {
  const auto check = [&](const char* machine, const fs::path& calibration) {
    return kerfbench(fmt::format("calibrate check --machine '{}' --calibration '{}' --results-dir '{}'",
                                 fixture(machine).string(), calibration.string(), path("check").string()));
  };
  const ProgramRun none = check("machines/two-mirror-100.yaml", path("none"));
  EXPECT_EQ(none.exit_code, 65);
  EXPECT_THAT(none.output, HasSubstr("none/head.json: no such file"));
  const ProgramRun other = check("machines/two-mirror-300.yaml", calibrated());
  EXPECT_EQ(other.exit_code, 65);
  EXPECT_THAT(other.output, HasSubstr("machine: is of two-mirror-100"));
  fs::create_directories(path("bad"));
  std::ofstream(path("bad/head.json")) << "{\"machine\": 3}";
  EXPECT_THAT(check("machines/two-mirror-100.yaml", path("bad")).output,
              HasSubstr("is not what `calibrate head` writes"));
  std::ofstream(path("bad/head.json"))
      << R"({"machine": "two-mirror-100", "good": false, "best_iteration": 0, "unmodelled_share": 0})";
  const ProgramRun bad = check("machines/two-mirror-100.yaml", path("bad"));
  EXPECT_THAT(bad.output, HasSubstr("good: false"));
  EXPECT_THAT(bad.output, HasSubstr("best_iteration: 0 is none"));
  EXPECT_THAT(bad.output, HasSubstr("unmodelled_share: must be above 0"));
}

/// Tests with a camera that sees the whole sheet at once, so that its lens's error is one over the sheet.
class Reversal : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = std::make_unique<ScratchFolder>();
    std::ofstream(machine()) << fmt::format(
        "extends: '{}'\nname: two-mirror-100\ncameras:\n  kerf: {{id: wide, calibration: wide.camera.yaml, "
        "size_px: "
        "[2640, 2640], pitch_mm: 0.06, height_mm: {}}}\n",
        fixture("machines/two-mirror-100.yaml").string(), kHeight_mm);
    const ProgramRun camera = kerfbench(fmt::format(
        "calibrate camera --machine '{}' --camera kerf --date 2026-11-20 --tilted 3 --residual-map '{}'",
        machine().string(), (shared_->path() / "map.svg").string()));
    ASSERT_EQ(camera.exit_code, 0) << camera.output;
  }
  static void TearDownTestSuite() { shared_.reset(); }
  static fs::path machine() { return shared_->path() / "wide.yaml"; }

  /// Changes the bench's configuration to another decentring of the lens.
  static void falsify() {
    std::string text = textOf(shared_->path() / "wide.camera.yaml");
    const auto line = text.find("distortion: [");
    const auto first = text.find(',', text.find(',', line) + 1) + 1;
    text.replace(first, text.find(',', first) - first, fmt::format(" {}", kDecentring));
    std::ofstream(shared_->path() / "wide.camera.yaml") << text;
  }
  [[nodiscard]] ProgramRun reversal(const std::string& options, const std::string& results) const {
    return kerfbench(fmt::format("calibrate reversal --machine '{}' --seed 2 {} --results-dir '{}'",
                                 machine().string(), options, path(results).string()));
  }
  [[nodiscard]] fs::path path(const std::string& name) const { return scratch_.path() / name; }
  [[nodiscard]] nlohmann::json json(const std::string& results) const {
    return nlohmann::json::parse(textOf(path(results) / "reversal.json"));
  }
  /// Largest difference of two results for the head.
  static double apart_mm(const nlohmann::json& a, const nlohmann::json& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.at("head").size(); ++i) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double one = a.at("head")[i].at("off_mm")[axis];
        const double other = b.at("head")[i].at("off_mm")[axis];
        most = std::max(most, std::abs(one - other));
      }
    }
    return most;
  }

  static constexpr double kHeight_mm = 500.0;
  static constexpr double kDecentring = 6e-4;  // Decentring p1 of the lens.
  static std::unique_ptr<ScratchFolder> shared_;
  ScratchFolder scratch_;
};
std::unique_ptr<ScratchFolder> Reversal::shared_;

TEST_F(Reversal, TellsTheCamerasErrorFromTheHeads) {
  const ProgramRun good = reversal("--grid 5 --keep-pictures", "good");
  ASSERT_EQ(good.exit_code, 0) << good.output;
  EXPECT_THAT(good.output, HasSubstr("no error of the camera that these views could tell"));
  EXPECT_THAT(good.output, HasSubstr("not told by these views: dx: x; dy: y"));
  EXPECT_GT(json("good").at("head_mm"), 1.0);

  falsify();
  const fs::path sheet = path("good/reversal");
  const auto pictures = [&](const char* third) {
    return fmt::format("--job '{}' --pictures '{}' '{}' '{}'", (sheet / "marks.yaml").string(),
                       (sheet / "pictures-0").string(), (sheet / "pictures-180").string(),
                       (sheet / third).string());
  };
  const ProgramRun bad = reversal(pictures("pictures-90"), "bad");
  ASSERT_EQ(bad.exit_code, 0) << bad.output;
  EXPECT_THAT(bad.output, HasSubstr("(dy: y^2, dx: x y, dy: x^2)"));
  // Error of a lens decentred by p1: dx = 2 p1 x y, dy = p1 (x² + 3 y²), 54 mm off the middle.
  const double rim_mm = kDecentring * 54.0 * 54.0 / kHeight_mm;
  for (const auto& term : json("bad").at("terms")) {
    const std::string name = term.at("name");
    const double expected = name == "dx: x y"   ? 2 * rim_mm
                            : name == "dy: x^2" ? rim_mm
                            : name == "dy: y^2" ? 3 * rim_mm
                                                : 0.0;
    const double sigma_mm = term.at("sigma_mm");
    EXPECT_NEAR(term.at("value_mm"), expected, 4.0 * sigma_mm + 0.05 * expected) << name;
  }
  // The head's error is the same with any camera.
  EXPECT_LT(apart_mm(json("good"), json("bad")), 0.003);

  // A sheet in another position than stated is no view.
  const ProgramRun turned = reversal(pictures("pictures-180"), "turned");
  EXPECT_EQ(turned.exit_code, 3) << turned.output;
  EXPECT_THAT(turned.output, HasSubstr("the sheet is not turned so"));
  const ProgramRun few = reversal(fmt::format("--job '{}' --pictures '{}'", (sheet / "marks.yaml").string(),
                                              (sheet / "pictures-0").string()),
                                  "few");
  EXPECT_EQ(few.exit_code, 65);
  EXPECT_THAT(few.output, HasSubstr("1 folders of pictures for 3 views"));
}

}  // namespace
}  // namespace kerfbench::test

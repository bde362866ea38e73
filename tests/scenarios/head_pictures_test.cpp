// SPDX-License-Identifier: Apache-2.0
// `calibrate head` from pictures that are spoiled: it says what is wrong and leaves the old table alone; a
// few marks that are missing or false change nothing that counts.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "hil/app/head_setup.h"
#include "hil/calibrate/tables/aim_grid.h"
#include "hil/camera/png.h"
#include "tests/scenarios/scenario_runs.h"
#include "tests/scenarios/spoiled_sheet.h"

namespace kerfbench::test {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kBadInput = 65;
constexpr int kInvalid = 3;
constexpr int kWaiting = 75;
constexpr double kLimit_mm = 0.010;

void writeText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A head that was calibrated on the twin by 49 marks, with all pictures, once for all tests.
class HeadPictures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = std::make_unique<ScratchFolder>();
    const ProgramRun run = kerfbench(
        fmt::format("calibrate head {} --keep-pictures --results-dir '{}'", options(), live().string()));
    ASSERT_EQ(run.exit_code, 0) << run.output;
    setup_ = std::make_unique<hil::HeadSetup>(hil::readHeadSetup(machine(), kGrid));
    clean_ = std::make_unique<SpoiledSheet>(live() / "1-grid", *setup_);
    ASSERT_EQ(clean_->numbers().size(), kMarks);
  }
  static void TearDownTestSuite() {
    clean_.reset();
    setup_.reset();
    shared_.reset();
  }

  static fs::path machine() { return fixture("machines/two-mirror-100.yaml"); }
  static std::string options() {
    return fmt::format("--machine '{}' --seed 2 --grids {} --verify 20", machine().string(), kGrid);
  }
  static fs::path live() { return shared_->path() / "live"; }
  static fs::path job() { return live() / "1-grid/marks.yaml"; }
  [[nodiscard]] fs::path path(const std::string& name) const { return scratch_.path() / name; }
  /// The clean sheet, to be spoiled.
  static SpoiledSheet sheet() { return *clean_; }
  /// The clean pictures, a copy.
  [[nodiscard]] fs::path copy(const std::string& name) const {
    fs::copy(live() / "1-grid/pictures", path(name));
    return path(name);
  }
  [[nodiscard]] fs::path written(const SpoiledSheet& spoiled) const {
    spoiled.write(path("pictures"));
    return path("pictures");
  }
  [[nodiscard]] ProgramRun run(const fs::path& job_file, const fs::path& pictures,
                               const fs::path& out) const {
    return kerfbench(fmt::format("calibrate head {} --job '{}' --pictures '{}' --results-dir '{}' --out '{}'",
                                 options(), job_file.string(), pictures.string(), path("results").string(),
                                 out.string()));
  }
  /// Refused with these words, and nothing is written or changed.
  void refused(const fs::path& pictures, int exit_code, const std::vector<std::string>& words,
               const fs::path& job_file = job()) const {
    writeText(path("old.csv"), "somebody works with this");
    fs::remove_all(path("results"));
    const ProgramRun got = run(job_file, pictures, path("old.csv"));
    EXPECT_EQ(got.exit_code, exit_code) << got.output;
    for (const std::string& word : words) EXPECT_THAT(got.output, HasSubstr(word));
    EXPECT_EQ(textOf(path("old.csv")), "somebody works with this");
    EXPECT_TRUE(fs::is_empty(path("results")));
    for (const auto& file : fs::directory_iterator(scratch_.path()))
      EXPECT_THAT(file.path().filename().string(), Not(HasSubstr("old.csv."))) << "half a table";
  }
  void refused(const SpoiledSheet& spoiled, const std::vector<std::string>& words) const {
    std::vector<std::string> all = words;
    all.emplace_back("INVALID: no table is written");
    all.push_back(path("pictures").string() + ": job 1-grid: ");
    refused(written(spoiled), kInvalid, all);
  }

  static constexpr int kGrid = 7;
  static constexpr std::size_t kMarks = 49;
  static constexpr double kPitch_mm = 100.0 / (kGrid - 1);
  static std::unique_ptr<ScratchFolder> shared_;
  static std::unique_ptr<hil::HeadSetup> setup_;
  static std::unique_ptr<SpoiledSheet> clean_;
  ScratchFolder scratch_;
};
std::unique_ptr<ScratchFolder> HeadPictures::shared_;
std::unique_ptr<hil::HeadSetup> HeadPictures::setup_;
std::unique_ptr<SpoiledSheet> HeadPictures::clean_;

TEST_F(HeadPictures, ThreeMarksMissingAndOneFalseLeaveTheTableWithinItsLimit) {
  SpoiledSheet spoiled = sheet();
  for (const int number : {0, 17, 31}) spoiled.erase(number);
  spoiled.move(24, {0.3, -0.2});
  spoiled.again(40, {0.5 * kPitch_mm, 0.5 * kPitch_mm});
  const ProgramRun got = run(job(), written(spoiled), path("table.csv"));
  ASSERT_EQ(got.exit_code, 0) << got.output;
  EXPECT_THAT(got.output, HasSubstr("3 marks not found: 0, 17, 31"));
  EXPECT_THAT(got.output, HasSubstr("1 mark found more than once, not used: 40"));
  EXPECT_THAT(got.output, HasSubstr("45 of 49 marks found"));
  EXPECT_THAT(got.output, HasSubstr("1 mark that disagrees with all others and left out: 24"));

  // As far from the table of all marks as both may be from the truth.
  const auto live_json = nlohmann::json::parse(textOf(live() / "head.json"));
  const double clean_mm = live_json.at("iterations").back().at("after").at("max_mm");
  const hil::AimGrid table = hil::readControllerTable(path("table.csv"));
  const hil::AimGrid whole = hil::readControllerTable(live() / "correction.csv");
  double apart_mm = 0.0;
  for (const double x : table.x_mm()) {
    for (const double y : table.y_mm())
      apart_mm = std::max(apart_mm, (table.at_mm({x, y}).value() - whole.at_mm({x, y}).value()).norm());
  }
  EXPECT_GT(apart_mm, 0.0);
  EXPECT_LT(clean_mm + apart_mm, kLimit_mm);
}

TEST_F(HeadPictures, ASheetThatWasNotCutOrNotWholeIsRefused) {
  SpoiledSheet blank = sheet();
  for (const int number : blank.numbers()) blank.erase(number);
  refused(blank, {"only 0 of 49 marks can be used", "49 marks not found: 0, 1, 2"});
  SpoiledSheet few = sheet();
  for (int number = 0; number < 30; ++number) few.erase(number);
  refused(few, {"only 19 of 49 marks can be used", "30 marks not found: 0, 1, 2"});
  // Enough, but a table would reach far beyond them.
  SpoiledSheet half = sheet();
  for (int number = 0; number < 14; ++number) half.erase(number);
  refused(half, {"a part of the field has no marks",
                 "the marks found reach from y = -16.6667 to 50 mm, those of the job from -50 to 50 mm",
                 "14 marks not found"});
}

TEST_F(HeadPictures, ASheetThatWasCutTwiceIsRefused) {
  SpoiledSheet aside = sheet();
  for (const int number : aside.numbers()) aside.again(number, {0.5 * kPitch_mm, 0.5 * kPitch_mm});
  refused(aside, {"49 marks are there more than once: two sheets are mixed, or the job was cut twice"});
  SpoiledSheet across = sheet();
  for (const int number : across.numbers()) across.again(number, {0.6, 0.4});
  refused(across, {"of 49 marks can be used"});
}

TEST_F(HeadPictures, SheetsThatAreMixedOrOfAnotherJobAreRefused) {
  refused(live() / "1-verify-1/pictures", kInvalid, {"20 of 20 marks found are none of the job's"});
  // Pictures of both in one folder.
  const fs::path both = copy("both");
  std::string list = textOf(both / "tiles.yaml");
  for (const auto& file : fs::directory_iterator(live() / "1-verify-1/pictures")) {
    const std::string name = file.path().filename().string();
    if (name == "tiles.yaml") continue;
    fs::copy(file.path(), both / ("other-" + name));
  }
  std::string others = textOf(live() / "1-verify-1/pictures/tiles.yaml");
  for (auto at = others.find("tile-"); at != std::string::npos; at = others.find("tile-", at + 12))
    others.insert(at, "other-");
  list += others.substr(others.find("  - "));
  writeText(both / "tiles.yaml", list);
  refused(both, kInvalid, {"INVALID"});
  // Half the pictures are of another sheet of this very job, which lies otherwise on the table.
  SpoiledSheet half = sheet();
  for (std::size_t tile = half.size() / 2; tile < half.size(); ++tile) half.shift(tile, {1.1, -0.7});
  refused(half, {"registration marks"});
}

TEST_F(HeadPictures, ABoardThatLiesWrongOrIsAnotherIsRefused) {
  SpoiledSheet bare = sheet();
  bare.erasePrint();
  refused(bare, {"no registration mark found"});
  SpoiledSheet turned = sheet();
  turned.changeAll([](cv::Mat& picture) { cv::flip(picture, picture, -1); });
  refused(turned, {"registration marks"});
  SpoiledSheet mirrored = sheet();
  mirrored.changeAll([](cv::Mat& picture) { cv::flip(picture, picture, 1); });
  refused(mirrored, {"only 2 of 6 printed marks are there", "the field is mirrored: x runs backwards"});
}

TEST_F(HeadPictures, PicturesOfAnotherScaleAreRefused) {
  const auto scaled = [&](double by) {
    SpoiledSheet other = sheet();
    other.changeAll([by](cv::Mat& picture) {
      const cv::Point2f middle(0.5F * static_cast<float>(picture.cols),
                               0.5F * static_cast<float>(picture.rows));
      cv::warpAffine(picture.clone(), picture, cv::getRotationMatrix2D(middle, 0.0, by), picture.size(),
                     cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    });
    return other;
  };
  refused(scaled(1.02), {"registration marks"});
}

TEST_F(HeadPictures, PicturesThatShowNothingAreNamed) {
  SpoiledSheet dark = sheet();
  dark.change(3, [](cv::Mat& picture) { picture.setTo(0); });
  dark.change(5, [](cv::Mat& picture) { picture.setTo(255); });
  refused(dark, {"1 of 12 pictures of the kerf camera are dark: number 4",
                 "1 of 12 pictures of the kerf camera are saturated: number 6",
                 "2 of 12 pictures of the kerf camera are without any noise: number 4, 6"});
  SpoiledSheet bright = sheet();
  bright.changeAll([](cv::Mat& picture) { picture.convertTo(picture, -1, 10.0); });
  refused(bright, {"12 of 12 pictures of the kerf camera are saturated: number 1, 2"});
  SpoiledSheet blurred = sheet();
  blurred.changeAll([](cv::Mat& picture) {
    cv::GaussianBlur(picture.clone(), picture, {}, 6.0, 6.0, cv::BORDER_REPLICATE);
  });
  refused(blurred, {"the pictures of the kerf camera are blurred by"});
}

TEST_F(HeadPictures, EveryPictureThatCannotBeReadIsNamed) {
  const fs::path folder = copy("pictures");
  const std::string whole = textOf(folder / "tile-0001.png");
  writeText(folder / "tile-0001.png", whole.substr(0, whole.size() / 2));
  writeText(folder / "tile-0004.png", "GIF89a and no more");
  writeText(folder / "tile-0006.png", "");
  std::string spoiled = textOf(folder / "tile-0008.png");
  spoiled[spoiled.size() / 2] = static_cast<char>(spoiled[spoiled.size() / 2] ^ 0x55);
  writeText(folder / "tile-0008.png", spoiled);
  std::vector<std::string> words;
  for (const int tile : {1, 4, 6, 8})
    words.push_back(fmt::format("pictures/tile-{:04}.png: is no picture that can be read", tile));
  refused(folder, kBadInput, words);
}

TEST_F(HeadPictures, PicturesOfAnotherSizeAreNamed) {
  const fs::path folder = copy("pictures");
  const std::vector<std::uint8_t> small = hil::encodePng(GrayImage(640, 480, 90));
  writeText(folder / "tile-0002.png", {small.begin(), small.end()});
  refused(folder, kBadInput,
          {"pictures/tile-0002.png: has 640 x 480 pixels, the camera is calibrated for 2048 x 1536"});
}

TEST_F(HeadPictures, AListThatIsNotWholeSaysAllThatIsWrong) {
  const fs::path folder = copy("pictures");
  const std::string list = textOf(folder / "tiles.yaml");
  fs::remove(folder / "tile-0003.png");
  fs::remove(folder / "tile-0007.png");
  refused(folder, kBadInput,
          {"tiles.yaml:6: tiles[3].file: there is no", "tiles.yaml:10: tiles[7].file: there is no"});
  writeText(folder / "tiles.yaml",
            "version: 1\ntiles:\n  - {file: tile-0000.png, p_TV_mm: [1, here]}\n"
            "  - {file: tile-0000.png, place: [1, 2]}\n");
  refused(folder, kBadInput,
          {"tiles.yaml:3: tiles[0].p_TV_mm", "tiles.yaml:4: tiles[1].p_TV_mm",
           "tiles.yaml:4: tiles[1].file: tile-0000.png is listed twice", "tiles.yaml:4: tiles[1].place"});
  writeText(folder / "tiles.yaml", list.substr(0, list.size() - 12));
  refused(folder, kBadInput, {"tiles.yaml:"});
  writeText(folder / "tiles.yaml", "version: 1\ntiles: []\n");
  refused(folder, kBadInput, {"tiles.yaml:2: tiles: there are none"});
  fs::remove(folder / "tiles.yaml");
  refused(folder, kBadInput, {"tiles.yaml: no such file"});
  refused(path("nowhere"), kBadInput, {"nowhere/tiles.yaml: no such file"});
}

TEST_F(HeadPictures, AJobThatWasChangedOrIsNoneIsRefused) {
  const fs::path pictures = live() / "1-grid/pictures";
  const std::string text = textOf(job());
  const auto with = [&](const std::string& what, const std::string& other) {
    std::string changed = text;
    changed.replace(changed.find(what), what.size(), other);
    writeText(path("marks.yaml"), changed);
    return path("marks.yaml");
  };
  refused(pictures, kBadInput, {"marks.yaml:4: digest: does not fit: the file was changed"},
          with("number: 8,", "number: 88,"));
  refused(pictures, kBadInput, {"number: 7 is there twice"}, with("number: 8,", "number: 7,"));
  refused(pictures, kBadInput, {"marks.yaml:"}, with("p_SW_mm", "p_WS_mm"));
  writeText(path("marks.yaml"), text.substr(0, text.size() / 2));
  refused(pictures, kBadInput, {"marks.yaml:"}, path("marks.yaml"));
  writeText(path("marks.yaml"), "\x01\x02");
  refused(pictures, kBadInput, {"marks.yaml"}, path("marks.yaml"));
  refused(pictures, kBadInput, {"none.yaml: no such file"}, path("none.yaml"));
  // The machine's name is in it.
  const ProgramRun other =
      kerfbench(fmt::format("calibrate head --machine '{}' --job '{}' --pictures '{}' --results-dir '{}'",
                            fixture("machines/two-mirror-300.yaml").string(), job().string(),
                            pictures.string(), path("r").string()));
  EXPECT_EQ(other.exit_code, kBadInput);
  EXPECT_THAT(other.output, HasSubstr("machine: the job is for two-mirror-100"));
}

TEST_F(HeadPictures, ByHandSpoiledPicturesAreToldAndTheRightOnesTakenLater) {
  writeText(path("old.csv"), "somebody works with this");
  const fs::path results = path("by-hand");
  const fs::path pictures = results / "1-grid/pictures";
  const auto again = [&] {
    const ProgramRun got = kerfbench(fmt::format("calibrate head {} --by-hand --results-dir '{}' --out '{}'",
                                                 options(), results.string(), path("old.csv").string()));
    EXPECT_EQ(textOf(path("old.csv")), "somebody works with this");
    EXPECT_FALSE(fs::exists(results / "head.json"));
    return got;
  };
  const auto refused_with = [&](int exit_code, const std::string& words) {
    const ProgramRun got = again();
    EXPECT_EQ(got.exit_code, exit_code) << got.output;
    EXPECT_THAT(got.output, HasSubstr(words));
    EXPECT_FALSE(fs::exists(results / "1-grid/measured.yaml"));
    EXPECT_FALSE(fs::exists(results / "correction-1.csv"));
    fs::remove_all(pictures);
  };
  EXPECT_EQ(again().exit_code, kWaiting);
  fs::copy(live() / "1-grid/pictures", pictures);
  fs::remove(pictures / "tiles.yaml");
  refused_with(kWaiting, "but no tiles.yaml");

  SpoiledSheet few = sheet();
  for (int number = 0; number < 30; ++number) few.erase(number);
  few.write(pictures);
  refused_with(kInvalid, "1-grid/pictures: job 1-grid: only 19 of 49 marks can be used");

  fs::copy(live() / "1-grid/pictures", pictures);
  writeText(pictures / "tile-0011.png", "no picture");
  refused_with(kBadInput, "1-grid/pictures/tile-0011.png: is no picture that can be read");

  SpoiledSheet some = sheet();
  for (const int number : {3, 20}) some.erase(number);
  some.move(11, {-0.2, 0.3});
  some.write(pictures);
  const ProgramRun right = again();
  EXPECT_EQ(right.exit_code, kWaiting) << right.output;
  EXPECT_THAT(right.output, HasSubstr("1-verify-1: a sheet is to be cut"));
  EXPECT_TRUE(fs::exists(results / "1-verify-1/table.csv"));
}

}  // namespace
}  // namespace kerfbench::test

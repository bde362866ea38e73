// SPDX-License-Identifier: Apache-2.0
// Command `calibrate head` with pictures that show something else than they should: it reports what is wrong
// and leaves the old table alone; a few marks that are missing or false change nothing that counts.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <opencv2/imgproc.hpp>

#include "hil/calibrate/tables/aim_grid.h"
#include "tests/scenarios/head_pictures.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kLimit_mm = 0.010;

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

  // The distance to the table of all marks may be the sum of both errors.
  const auto live_json = nlohmann::json::parse(textOf(live() / "head.json"));
  const double clean_mm = live_json.at("iterations").back().at("after").at("max_mm");
  const calibrate::AimGrid table = head_service::readControllerTable(path("table.csv"));
  const calibrate::AimGrid whole = head_service::readControllerTable(live() / "correction.csv");
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
  // The marks are enough, but a table would reach far beyond them.
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
  // One folder has pictures of both.
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
  // The printed marks still fit; the marks of neighbouring pictures no longer do.
  for (const double by : {1.001, 1.002}) {
    refused(scaled(by), {"do not agree on a head",
                         "mm RMS beside their places: the print is not true, or the camera's scale"});
  }
  // Here the printed marks still agree, and so do the pictures but for micrometres: no head bends like that.
  refused(scaled(1.0002), {"49 of 49 marks found", "do not agree on a head"});
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

}  // namespace
}  // namespace kerfbench::test

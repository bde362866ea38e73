// SPDX-License-Identifier: Apache-2.0
// Command `calibrate head` with files of pictures and jobs that are damaged, and with sheets cut by hand.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "hil/camera/png.h"
#include "tests/scenarios/head_pictures.h"
#include "twin/base/image.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

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
  const std::vector<std::uint8_t> small = camera::encodePng(GrayImage(640, 480, 90));
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
  // The job contains the machine's name.
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
  fs::remove_all(pictures);
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

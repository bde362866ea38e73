// SPDX-License-Identifier: Apache-2.0
// Keys of docs/reference/scenario.md compared with those of the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "hil/scenario/scenario.h"
#include "tests/docs/key_tables.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::scenario {
namespace {

namespace fs = std::filesystem;
using Asked = base::YamlReader::Asked;

class ScenarioKeys : public testing::Test {
 protected:
  ScenarioKeys() : page_(docs::tableRows("scenario.md", "key")) {
    standInForImages();
    // The scenarios are those of the project, and one for each key that none of them has.
    for (const auto& entry : fs::recursive_directory_iterator(base::fixture("scenarios"))) {
      if (entry.path().extension() == ".yaml") read(entry.path());
    }
    extend("native/label-on-belt.yaml",
           "select: {entities: '0-3'}\nplanner: {gcode: job.nc, jump_radius_mm: 1}\n"
           "board: {depth_curve: [{fluence_share: 0, depth_share: 0}, {fluence_share: 1, depth_share: 1}]}\n"
           "print: {areas: [{x_mm: 1, y_mm: 1, size_mm: [1, 1]}]}\n"
           "belt: {profile: [{at_s: 1, speed_mm_s: 61}]}\nlayers: {CUT: cut}\n");
    extend("native/label-on-belt.yaml",
           "firmware: {source: child, child: child.sh, image: controller-native, eeprom: blank}\n");
    extend("native/label-on-belt.yaml",
           "dieline: {file: " + base::fixture("dielines/label-60x40.dxf").string() +
               ", unit: mm, scale: 1, turn: 0, shift: [0, 0], accept: [gap]}\n");
    extend("label-on-belt.yaml", "firmware: {dialog: none, start_s: 0.2, quiet_s: 1}\n");
    extend("line-ok/plate.yaml",
           "wires: {galvo_x_pul: X_STEP}\nfirmware: {setup: ['$X'], ahead_bytes: 127}\n");
    extend("pins/plate-on-pins.yaml",
           "firmware: {source: analyser, driver: fx2lafw, samplerate_hz: 24000000, settings: {a: b}}\n");
    extend("pins/label-live.yaml", "firmware: {out_chip: gpiochip1, max_lag_us: 100}\n");
    extend("native/label-camera.yaml", "cameras: {spot: {lit_us: 10, gain: 1, controls: {a: 1}}}\n");
    extend("native/short-lines.yaml", "planner: {power: {half_depth_mm: 0.1}}\n");
    extend("native/label-on-belt.yaml", "cameras: {kerf: {source: tiles, folder: .}}\n");
    extend("safe/interlock.yaml", "provoke: {expect: interlock}\n");
  }
  /// Makes files in place of images. The reader tests only whether an image exists: none need be built.
  void standInForImages() const {
    static const std::regex image(R"(\bimage: ([\w.-]+))");
    for (const auto& entry : fs::recursive_directory_iterator(base::fixture("scenarios"))) {
      if (entry.path().extension() != ".yaml") continue;
      const std::string text = base::contentOf(entry.path());
      for (auto it = std::sregex_iterator(text.begin(), text.end(), image); it != std::sregex_iterator();
           ++it)
        (void)temp_.write((*it)[1], "");
    }
  }
  void extend(const std::string& shipped, const std::string& lines) {
    (void)temp_.write("job.nc", "");
    (void)temp_.write("child.sh", "");
    read(temp_.write(
        "s.yaml", fmt::format("extends: '{}'\n{}", base::fixture("scenarios/" + shipped).string(), lines)));
  }
  void read(const fs::path& path) {
    for (const Asked& key : readScenarioFile(path, {temp_.path()}).keys) {
      Asked& known = asked_[key.key];
      if (!known.range) known = key;
    }
  }
  // True for a container: sections stand as headings, free keys are described in words.
  static bool isContainer(const std::string& key) {
    static const std::set<std::string> sections{
        "belt",   "board",         "board.scorch",   "cameras",         "cameras.kerf", "cameras.spot",
        "checks", "firmware",      "planner",        "planner.faults",  "print",        "provoke",
        "select", "planner.power", "firmware.lines", "firmware.outputs"};
    return sections.contains(key) || key.starts_with("firmware.lines.") ||
           key.starts_with("firmware.outputs.");
  }

  const base::TempFolder temp_;
  std::map<std::string, docs::Row> page_;
  std::map<std::string, Asked> asked_;
};

TEST_F(ScenarioKeys, ThePageHasEveryKeyThatTheProgramAsksFor) {
  for (const auto& [key, asked] : asked_) {
    if (isContainer(key)) continue;
    EXPECT_TRUE(page_.contains(key)) << key << " is missing in docs/reference/scenario.md";
  }
}

TEST_F(ScenarioKeys, ThePageHasNoKeyThatNobodyAsksFor) {
  EXPECT_GT(page_.size(), 120U);
  for (const auto& [key, row] : page_) {
    // The reader itself looks for `extends`, before any key is asked for.
    if (key != "extends") {
      EXPECT_TRUE(asked_.contains(key)) << key;
    }
  }
}

TEST_F(ScenarioKeys, ThePageHasTheRangesAndDefaultsOfTheProgram) {
  int compared = 0;
  for (const auto& [key, asked] : asked_) {
    const auto found = page_.find(key);
    if (!asked.range || found == page_.end() || key == "version") continue;
    ++compared;
    EXPECT_EQ(found->second.at("range"), fmt::format("{:g} … {:g}", asked.range->min, asked.range->max))
        << key;
    if (asked.range->fallback) {
      EXPECT_EQ(found->second.at("default"), fmt::format("{:.10g}", *asked.range->fallback)) << key;
    } else {
      EXPECT_TRUE(found->second.at("default").starts_with("required") ||
                  found->second.at("default").starts_with("none"))
          << key << " has no default";
    }
  }
  EXPECT_GT(compared, 70);
}

}  // namespace
}  // namespace kerfbench::scenario

// SPDX-License-Identifier: Apache-2.0
// Keys of docs/reference/machine.md compared with those of the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "hil/machine_file/machine_file.h"
#include "tests/docs/key_tables.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::machine_file {
namespace {

// Description of each key on the page.
std::map<std::string, docs::Row> pageKeys() { return docs::tableRows("machine.md", "key"); }

class MachineKeys : public testing::Test {
 protected:
  // Keys of the program when it reads the machines of the project, and one that uses the other alternatives.
  [[nodiscard]] std::map<std::string, base::YamlReader::Asked> askedKeys() const {
    const auto other = [this](const std::string& name, const std::string& lines) {
      return temp_.write(name, "extends: " + base::fixture("machines/" + name).string() + "\n" + lines);
    };
    std::map<std::string, base::YamlReader::Asked> asked;
    for (const auto& path :
         {other("two-mirror.yaml",
                "frame: {mass_kg: 100, stiffness_n_mm: [2000, 2000]}\n"
                "galvo_x: {resonance_hz: ~, stiffness_n_m_rad: 75, resonance_damping: ~, "
                "stiffness_damping_n_m_s_rad: 6.0e-5}\n"
                "galvo_y: {resonance_hz: ~, stiffness_n_m_rad: 75, resonance_damping: ~, "
                "stiffness_damping_n_m_s_rad: 6.0e-5}\n"
                "belt: {feed: {resonance_hz: ~, stiffness_n_m_rad: 75, resonance_damping: ~, "
                "stiffness_damping_n_m_s_rad: 6.0e-5}}\n"),
          other("strip-gantry.yaml",
                "gantry_x: {stiffness_n_mm: ~, resonance_hz: 300, resonance_damping: ~, "
                "stiffness_damping_n_s_m: 80, "
                "servo: ~, step_mm: ~, stepper: {profile: 17HS4401}}\n"
                "gantry_y: {stiffness_n_mm: ~, resonance_hz: 300, resonance_damping: ~, "
                "stiffness_damping_n_s_m: 80, "
                "servo: ~, step_mm: ~, stepper: {profile: 17HS4401}}\n"
                "cameras: {spot: {link: {late_ms: 1, lost: [{first: 1}], late: [{first: 1}]}}}\n"),
          base::fixture("machines/two-mirror.yaml"), base::fixture("machines/strip-gantry.yaml"),
          base::fixture("machines/two-mirror-stepper.yaml"), base::fixture("machines/f-theta-300.yaml")}) {
      for (const base::YamlReader::Asked& key : readMachineFile(path).keys) {
        auto& known = asked[key.key];
        if (!known.range) known = key;
      }
    }
    return asked;
  }
  const base::TempFolder temp_;
};

// True for a container, which is described as a heading or as a section with keys of its own.
bool isContainer(const std::string& key) {
  return key == "frame" || key == "drivers" || key.starts_with("pins.");
}

TEST_F(MachineKeys, ThePageHasEveryKeyThatTheProgramAsksFor) {
  const auto page = pageKeys();
  for (const auto& [key, asked] : askedKeys()) {
    if (isContainer(key)) continue;
    EXPECT_TRUE(page.contains(key)) << key << " is missing in docs/reference/machine.md";
  }
}

TEST_F(MachineKeys, ThePageHasNoKeyThatNobodyAsksFor) {
  const auto asked = askedKeys();
  const auto page = pageKeys();
  EXPECT_GT(page.size(), 250U);
  for (const auto& [key, row] : page) EXPECT_TRUE(asked.contains(key)) << key;
}

TEST_F(MachineKeys, ThePageHasTheRangesAndDefaultsOfTheProgram) {
  const auto page = pageKeys();
  for (const auto& [key, asked] : askedKeys()) {
    const auto found = page.find(key);
    if (!asked.range || found == page.end() || key == "version") continue;
    EXPECT_EQ(found->second.at("range"), fmt::format("{:g} … {:g}", asked.range->min, asked.range->max))
        << key;
    // The default of a key inside a drive is the profile's value; the catalogue's own keys are checked.
    if (key.find(".servo.") != std::string::npos || key.find(".stepper.") != std::string::npos) continue;
    const auto& fallback = asked.range->fallback;
    const std::string said = found->second.at("default");
    if (!fallback) {
      EXPECT_TRUE(said == "required" || said == "or") << key << " is required";
    } else if (key != "laser.fall_time_us") {
      EXPECT_EQ(said, std::isinf(*fallback) ? "none" : fmt::format("{:g}", *fallback)) << key;
    }
  }
}

TEST_F(MachineKeys, TheTwoMirrorFileShowsEveryKeyThatItMayHave) {
  // The key stands alone, or in a comment.
  const std::string text = base::contentOf(base::fixture("machines/two-mirror.yaml"));
  for (const base::YamlReader::Asked& asked :
       readMachineFile(base::fixture("machines/two-mirror.yaml")).keys) {
    const std::string key = asked.key.substr(asked.key.rfind('.') + 1);
    // The key belongs to the catalogue.
    if (asked.key.find("[]") != std::string::npos && !asked.key.starts_with("laser.")) continue;
    if (asked.key == "servos" || asked.key == "steppers" || asked.key == "pins.power_monitor") continue;
    EXPECT_TRUE(std::regex_search(text, std::regex("\\b" + key + "\\b"))) << asked.key;
  }
}

}  // namespace
}  // namespace kerfbench::machine_file

// SPDX-License-Identifier: Apache-2.0
// docs/MACHINES.md against the keys that the program asks for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "hil/machine_file/machine_file.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::machine_file {
namespace {

struct Documented {
  std::string range, fallback;
};

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::vector<std::string> inBackticks(const std::string& text) {
  const std::regex quoted("`([^`]+)`");
  std::vector<std::string> words;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), quoted); it != std::sregex_iterator(); ++it)
    words.push_back((*it)[1]);
  return words;
}

// All keys of the page, each with its prefix.
std::map<std::string, Documented> pageKeys() {
  std::istringstream page(
      base::contentOf(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs" / "MACHINES.md"));
  std::map<std::string, Documented> keys;
  std::vector<std::string> prefixes{""};
  bool in_keys = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) prefixes = {""};
    if (line.starts_with("Prefix: ")) prefixes = inBackticks(line);
    if (!line.starts_with("|")) in_keys = false;
    if (line.starts_with("| key |")) in_keys = true;
    if (!in_keys || !line.starts_with("| `")) continue;
    std::istringstream cells(line);
    std::string skipped, key, range, fallback;
    std::getline(cells, skipped, '|');
    std::getline(cells, key, '|');
    std::getline(cells, range, '|');
    std::getline(cells, fallback, '|');
    for (const std::string& prefix : prefixes)
      keys.emplace(prefix + inBackticks(key).at(0), Documented{trimmed(range), trimmed(fallback)});
  }
  return keys;
}

class MachineKeys : public testing::Test {
 protected:
  // What the program asks for when it reads the machines of the house, and one in which the alternatives are
  // used that none of them has.
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

// Containers stand as headings or as sections with keys of their own.
bool isContainer(const std::string& key) {
  return key == "frame" || key == "drivers" || key.starts_with("pins.");
}

TEST_F(MachineKeys, ThePageHasEveryKeyThatTheProgramAsksFor) {
  const auto page = pageKeys();
  for (const auto& [key, asked] : askedKeys()) {
    if (isContainer(key)) continue;
    EXPECT_TRUE(page.contains(key)) << key << " is missing in docs/MACHINES.md";
  }
}

TEST_F(MachineKeys, ThePageHasNoKeyThatNobodyAsksFor) {
  const auto asked = askedKeys();
  const auto page = pageKeys();
  EXPECT_GT(page.size(), 250U);
  for (const auto& [key, documented] : page) EXPECT_TRUE(asked.contains(key)) << key;
}

TEST_F(MachineKeys, ThePageHasTheRangesAndDefaultsOfTheProgram) {
  const auto page = pageKeys();
  for (const auto& [key, asked] : askedKeys()) {
    const auto found = page.find(key);
    if (!asked.range || found == page.end() || key == "version") continue;
    EXPECT_EQ(found->second.range, fmt::format("{:g} … {:g}", asked.range->min, asked.range->max)) << key;
    // Inside a drive the profile's value is the default; the catalogue's own keys are checked.
    if (key.find(".servo.") != std::string::npos || key.find(".stepper.") != std::string::npos) continue;
    const auto& fallback = asked.range->fallback;
    const std::string said = found->second.fallback;
    if (!fallback) {
      EXPECT_TRUE(said == "required" || said == "or") << key << " is required";
    } else if (key != "laser.fall_time_us") {
      EXPECT_EQ(said, std::isinf(*fallback) ? "none" : fmt::format("{:g}", *fallback)) << key;
    }
  }
}

TEST_F(MachineKeys, TheTwoMirrorFileShowsEveryKeyThatItMayHave) {
  // As a key of its own, or in a comment.
  const std::string text = base::contentOf(base::fixture("machines/two-mirror.yaml"));
  for (const base::YamlReader::Asked& asked :
       readMachineFile(base::fixture("machines/two-mirror.yaml")).keys) {
    const std::string key = asked.key.substr(asked.key.rfind('.') + 1);
    if (asked.key.find("[]") != std::string::npos && !asked.key.starts_with("laser."))
      continue;  // Of the catalogue.
    if (asked.key == "servos" || asked.key == "steppers" || asked.key == "pins.power_monitor") continue;
    EXPECT_TRUE(std::regex_search(text, std::regex("\\b" + key + "\\b"))) << asked.key;
  }
}

}  // namespace
}  // namespace kerfbench::machine_file

// SPDX-License-Identifier: Apache-2.0
// The reference as data, held against what the readers of scenarios and machines ask for.
#include "hil/desk/reference_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/scenario.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Keys of a page by their whole path, under each of their prefixes.
std::map<std::string, ReferenceKey> keysOf(const std::string& page) {
  std::map<std::string, ReferenceKey> keys;
  for (const ReferenceSection& section :
       referenceSections(base::contentOf(referencePage(page, kRequest.bin_dir))))
    for (const std::string& prefix : section.prefixes)
      for (const ReferenceKey& key : section.keys) keys[prefix + key.key] = key;
  return keys;
}

/// What a reader asks for of all shipped files of a folder.
std::map<std::string, base::YamlReader::Asked> askedIn(
    const std::string& folder,
    const std::function<std::vector<base::YamlReader::Asked>(const fs::path&)>& keys_of) {
  std::map<std::string, base::YamlReader::Asked> asked;
  for (const auto& entry : fs::recursive_directory_iterator(base::fixture(folder))) {
    if (entry.path().extension() != ".yaml") continue;
    std::vector<base::YamlReader::Asked> keys;
    try {
      keys = keys_of(entry.path());
    } catch (const base::ConfigError&) {
      continue;  // A catalogue, a calibration.
    }
    for (const base::YamlReader::Asked& key : keys) {
      base::YamlReader::Asked& known = asked[key.key];
      if (!known.range) known = key;
    }
  }
  return asked;
}

const std::map<std::string, base::YamlReader::Asked>& askedOfScenarios() {
  static const auto kAsked = askedIn("scenarios", [](const fs::path& file) {
    return scenario::draftScenario(file, base::contentOf(file), {fs::path(KERFBENCH_BINARY_DIR) / "firmware"})
        .keys;
  });
  return kAsked;
}

std::map<std::string, base::YamlReader::Asked> askedOfMachines() {
  return askedIn("machines", [](const fs::path& file) { return machine_file::readMachineFile(file).keys; });
}

void expectRangesAgree(const std::map<std::string, ReferenceKey>& keys,
                       const std::map<std::string, base::YamlReader::Asked>& asked, int least) {
  int numbers = 0;
  for (const auto& [key, reader] : asked) {
    const auto found = keys.find(key);
    if (found == keys.end()) continue;  // A section; the keys' own tests say that no key is missing.
    const KeyKind kind = found->second.range.kind;
    const bool is_number = kind == KeyKind::kNumber || kind == KeyKind::kNumbers;
    // A reader asks first whether a key that may be missing is there, and nothing else where it is not.
    if (!reader.range || key == "version") continue;
    EXPECT_TRUE(is_number) << key << " is '" << nameOf(kind) << "'";
    if (!is_number) continue;
    ++numbers;
    // The page has six digits.
    EXPECT_NEAR(*found->second.range.least, reader.range->min, 1e-5 * std::abs(reader.range->min)) << key;
    EXPECT_NEAR(*found->second.range.most, reader.range->max, 1e-5 * std::abs(reader.range->max)) << key;
  }
  EXPECT_GT(numbers, least);
}

TEST(ReferenceKeys, EveryNumberOfTheReadersIsANumberOfThePagesWithItsRange) {
  expectRangesAgree(keysOf("scenario"), askedOfScenarios(), 60);
  expectRangesAgree(keysOf("machine"), askedOfMachines(), 150);
}

TEST(ReferenceKeys, EveryKeyThatTheScenarioReaderAsksForIsThere) {
  const auto keys = keysOf("scenario");
  for (const auto& [key, reader] : askedOfScenarios()) {
    const bool is_section = std::ranges::any_of(
        keys, [&, &key = key](const auto& other) { return other.first.starts_with(key + "."); });
    const bool is_free = key.starts_with("firmware.lines.") || key.starts_with("firmware.outputs.");
    EXPECT_TRUE(keys.contains(key) || is_section || is_free) << key;
  }
}

TEST(ReferenceKeys, KindsAreThoseOfTheShippedValues) {
  // No key may be a text only because nobody understood its range.
  const std::set<std::string> kTexts{
      "text", "name", "day", "list as text", "file, number or name", "file, tcp:HOST:PORT"};
  std::size_t flags = 0, choices = 0;
  for (const std::string page : {"scenario", "machine"}) {
    for (const auto& [path, key] : keysOf(page)) {
      if (key.range.kind == KeyKind::kText) EXPECT_TRUE(kTexts.contains(key.range_text)) << path;
      if (key.range.kind == KeyKind::kChoice) {
        EXPECT_GE(key.range.choices.size() + (key.range.or_file || key.range.or_list ? 1 : 0), 2U) << path;
        ++choices;
      }
      if (key.range.kind == KeyKind::kFlag) ++flags;
      EXPECT_TRUE(key.required.empty() != key.fallback.empty()) << path;
    }
  }
  EXPECT_GT(flags, 15U);
  EXPECT_GT(choices, 15U);
}

/// Calls for each value of a file, elements of lists of mappings without their number.
void visit(const YAML::Node& node, const std::string& path,
           const std::function<void(const std::string&, const YAML::Node&)>& call) {
  for (const auto& entry : node) {
    const std::string key = path + entry.first.Scalar();
    call(key, entry.second);
    if (entry.second.IsMap()) visit(entry.second, key + ".", call);
    if (!entry.second.IsSequence()) continue;
    for (const YAML::Node& element : entry.second)
      if (element.IsMap()) visit(element, key + "[].", call);
  }
}

TEST(ReferenceKeys, TheShippedFilesHoldAsManyNumbersAsTheKeysSay) {
  int several = 0;
  for (const std::string page : {"scenario", "machine"}) {
    const auto keys = keysOf(page);
    for (const auto& entry : fs::recursive_directory_iterator(base::fixture(page + "s"))) {
      if (entry.path().extension() != ".yaml") continue;
      visit(YAML::LoadFile(entry.path().string()), "", [&](const std::string& path, const YAML::Node& value) {
        const auto found = keys.find(path);
        if (found == keys.end() || !value.IsDefined() || value.IsNull()) return;
        const ReferenceKey& key = found->second;
        const KeyKind kind = key.range.kind;
        if (kind == KeyKind::kNumber) EXPECT_TRUE(value.IsScalar()) << entry.path() << ": " << path;
        if (kind == KeyKind::kNumbers) {
          EXPECT_TRUE(value.IsSequence()) << entry.path() << ": " << path;
          EXPECT_EQ(value.size(), key.count) << entry.path() << ": " << path;
          ++several;
        }
        if (kind == KeyKind::kChoice && value.IsScalar() && !key.range.or_file)
          EXPECT_THAT(key.range.choices, testing::Contains(value.Scalar())) << entry.path() << ": " << path;
        if (value.IsMap()) EXPECT_TRUE(kind == KeyKind::kSection || key.range.or_section) << path;
      });
    }
  }
  EXPECT_GT(several, 20);
}

TEST(ReferenceKeys, WhatARangeSays) {
  EXPECT_EQ(keyRangeFrom("0.01 … 3600")->kind, KeyKind::kNumber);
  EXPECT_EQ(*keyRangeFrom("-1e+09 … 1e+09")->least, -1e9);
  EXPECT_EQ(*keyRangeFrom("1")->most, 1.0);
  EXPECT_EQ(keyRangeFrom("constant, list")->choices, std::vector<std::string>{"constant"});
  EXPECT_TRUE(keyRangeFrom("constant, list")->or_list);
  EXPECT_EQ(keyRangeFrom("`blank`, file")->choices, std::vector<std::string>{"blank"});
  EXPECT_TRUE(keyRangeFrom("`blank`, file")->or_file);
  EXPECT_TRUE(keyRangeFrom("file or section")->or_section);
  for (const char* unknown : {"", "words", "3 … 1", "1 … many", "a, B c"})
    EXPECT_FALSE(keyRangeFrom(unknown)) << unknown;
}

TEST(ReferenceKeys, UnitsComeFromTheEndOfTheKey) {
  EXPECT_EQ(unitOf("belt.speed_mm_s"), "mm/s");
  EXPECT_EQ(unitOf("acceleration_mm_s2"), "mm/s²");
  EXPECT_EQ(unitOf("friction.viscous_n_m_s_rad"), "N m s/rad");
  EXPECT_EQ(unitOf("cut_energy_j_per_mm"), "J/mm");
  EXPECT_EQ(unitOf("marks[].x_mm"), "mm");
  EXPECT_EQ(unitOf("seed"), "");
  EXPECT_EQ(unitOf("depth_share"), "");
}

TEST(ReferenceKeys, ARowThatIsNotUnderstoodIsRefusedByName) {
  EXPECT_THAT(
      [] {
        referenceSections(
            "## A\n\nPrefix: `a.`\n\n| key | range | default | meaning |\n|-|-|-|-|\n"
            "| `b` | whatever it takes | 1 | Words. |\n");
      },
      testing::ThrowsMessage<base::InputError>(testing::HasSubstr("a.b")));
}

TEST(ReferenceKeys, TheAnswerHasEverySectionWithHelpAsPlainElements) {
  const json answer = json::parse(referenceJson("scenario", kRequest.bin_dir));
  std::set<std::string> paths;
  for (const json& section : answer["sections"]) {
    for (const json& key : section["keys"]) {
      paths.insert(key["path"]);
      const std::string help = key["help_html"];
      // Elements have no attributes, so that no address and no script can be in one.
      for (std::size_t at = help.find('<'); at != std::string::npos; at = help.find('<', at + 1))
        EXPECT_EQ(help.find_first_of(" =", at) < help.find('>', at), false) << help;
    }
  }
  EXPECT_GT(paths.size(), 150U);
  EXPECT_TRUE(paths.contains("belt.speed_mm_s"));
  EXPECT_TRUE(paths.contains("planner.faults.skip_entity"));
  EXPECT_THROW((void)referenceJson("../machine", kRequest.bin_dir), base::InputError);
}

}  // namespace
}  // namespace kerfbench::desk

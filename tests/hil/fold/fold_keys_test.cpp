// SPDX-License-Identifier: Apache-2.0
// The tables of docs/reference/fold.md against the keys, ranges and defaults that the program asks for.
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hil/fold/fold_scenario.h"
#include "tests/docs/key_tables.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::fold {
namespace {

using Asked = base::YamlReader::Asked;

class FoldKeys : public testing::Test {
 protected:
  FoldKeys() : page_(docs::tableRows("fold.md", "key")) {
    add(readFoldScenario(base::fixture("fold/box-corner-left.yaml")));
    (void)temp_.write("p.gcode", "G00 X0 Y0 Z0 A0 C0\nG01 X1\n");
    add(readFoldScenario(
        temp_.write("s.yaml", fmt::format("extends: '{}'\nprogram: {{gcode: p.gcode}}\n",
                                          base::fixture("fold/box-corner-left.yaml").string()))));
  }
  void add(const FoldScenario& scenario) {
    for (const Asked& key : scenario.keys) asked_.try_emplace(key.key, key);
    for (const Asked& key : scenario.machine.keys) asked_.try_emplace("machine:" + key.key, key);
  }
  [[nodiscard]] static bool isContainer(const std::string& key) {
    static const std::set<std::string> sections{"kerf",   "program", "board",
                                                "limits", "errors",  "axes",
                                                "beam",   "laser",   "survey[].calibration",
                                                "faces",  "survey",  "faces[].marks"};
    return sections.contains(key.starts_with("machine:") ? key.substr(8) : key);
  }

  const base::TempFolder temp_;
  std::map<std::string, docs::Row> page_;
  std::map<std::string, Asked> asked_;
};

TEST_F(FoldKeys, AreThoseOfThePage) {
  for (const auto& [key, asked] : asked_) {
    if (!isContainer(key)) EXPECT_TRUE(page_.contains(key)) << key << " is missing in docs/reference/fold.md";
  }
  for (const auto& [key, row] : page_) EXPECT_TRUE(asked_.contains(key)) << key;
}

TEST_F(FoldKeys, HaveTheRangesAndDefaultsOfThePage) {
  int compared = 0;
  for (const auto& [key, asked] : asked_) {
    const auto found = page_.find(key);
    if (!asked.range || found == page_.end() || key.ends_with("version")) continue;
    ++compared;
    EXPECT_EQ(found->second.at("range"), fmt::format("{:g} … {:g}", asked.range->min, asked.range->max))
        << key;
    if (asked.range->fallback && !key.starts_with("errors.") && key != "program.kerf_radius_mm") {
      EXPECT_EQ(found->second.at("default"), fmt::format("{:.10g}", *asked.range->fallback)) << key;
    }
  }
  EXPECT_GT(compared, 40);
}

}  // namespace
}  // namespace kerfbench::fold

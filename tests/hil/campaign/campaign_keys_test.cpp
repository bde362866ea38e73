// SPDX-License-Identifier: Apache-2.0
// The tables of docs/reference/campaign.md against the keys that the program asks for.
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "hil/campaign/campaign_file.h"
#include "tests/docs/key_tables.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::campaign {
namespace {

/// Asks for every key once.
constexpr const char* kAllKeys =
    "version: 1\n"
    "name: all\n"
    "base: base.yaml\n"
    "set: {twin: fast}\n"
    "set_machine: {belt: {mass_kg: 1}}\n"
    "factors:\n"
    "  - {name: a, key: a, uniform: [0, 1]}\n"
    "  - {name: b, machine: b, log_uniform: [1, 2]}\n"
    "  - {name: c, normal: {mean: 0, sigma: 1, min: -1, max: 1}, changes: [{key: c, set: '{value}'}]}\n"
    "  - name: f\n"
    "    faults:\n"
    "      - {name: u, size: {uniform: [0, 1]}, changes: [{machine: u, scale_by: 1}]}\n"
    "      - {name: n, size: {normal: {mean: 0, sigma: 1}}, changes: [{key: n, shift_by: 1}]}\n"
    "      - {name: v, size: {values: [1]}, changes: [{key: v, set: '{size}'}]}\n";

TEST(CampaignKeys, AreThoseOfThePage) {
  const base::TempFolder folder;
  (void)folder.write("base.yaml", "version: 1\n");
  const auto page = docs::tableRows("campaign.md", "key");
  const std::set<std::string> sections{"factors[].normal", "factors[].faults[].size.normal"};
  std::set<std::string> asked;
  for (const base::YamlReader::Asked& key : campaignKeys(folder.write("c.yaml", kAllKeys))) {
    if (sections.contains(key.key)) continue;
    asked.insert(key.key);
    EXPECT_TRUE(page.contains(key.key)) << key.key << " is missing in docs/reference/campaign.md";
  }
  for (const auto& [key, row] : page)
    if (key != "extends") EXPECT_TRUE(asked.contains(key)) << key;
}

}  // namespace
}  // namespace kerfbench::campaign

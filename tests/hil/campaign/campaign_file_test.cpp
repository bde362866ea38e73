// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/campaign_file.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;

class CampaignFile : public testing::Test {
 protected:
  CampaignFile() { (void)folder_.write("base.yaml", "version: 1\nname: base\nbelt: {speed_mm_s: 10}\n"); }

  Campaign read(const std::string& text) {
    return readCampaign(folder_.write("c.yaml", "version: 1\nname: c\nbase: base.yaml\n" + text));
  }
  /// All that is wrong with a file, one line each.
  std::string faultsOf(const std::string& text) {
    try {
      (void)read(text);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }

  base::TempFolder folder_;
};

TEST_F(CampaignFile, ASmallOneIsRead) {
  const Campaign c = read(
      "title: speeds\n"
      "seed: 7\n"
      "repeats: 3\n"
      "set: {twin: fast, planner: {order: drawn}}\n"
      "set_machine: {belt: {mass_kg: 1}}\n"
      "factors:\n"
      "  - {name: speed, key: belt.speed_mm_s, values: [10, 20, 30]}\n"
      "  - name: fault\n"
      "    faults:\n"
      "      - {name: none}\n"
      "      - name: scale\n"
      "        size: [0.1, 0.2]\n"
      "        changes: [{machine: controller.x, scale_by: 2}, {key: board.y, set: \"[1, {size}]\"}]\n");
  EXPECT_EQ(c.seed, 7U);
  ASSERT_EQ(c.fixed.size(), 3U);
  EXPECT_EQ(c.fixed[1].key, "planner.order");
  EXPECT_TRUE(c.fixed[2].of_machine);
  ASSERT_EQ(c.factors.size(), 2U);
  EXPECT_EQ(c.factors[0].kinds[0].changes[0].text, kValueHolder);
  ASSERT_EQ(c.factors[1].kinds.size(), 2U);
  EXPECT_FALSE(c.factors[1].kinds[0].values);
  EXPECT_EQ(c.factors[1].kinds[1].changes[0].how, Change::How::kScale);
  EXPECT_TRUE(c.own_seeds);
  // Three speeds; none, and two sizes; three times each.
  EXPECT_EQ(c.runs(), 27U);
}

TEST_F(CampaignFile, DrawsAreSoManyRuns) {
  EXPECT_EQ(read("draws: 500\nfactors: [{name: a, key: board.a, uniform: [0, 1]}]\n").runs(), 500U);
  // What is drawn has one place in a grid.
  EXPECT_EQ(read("repeats: 4\nfactors: [{name: a, key: board.a, uniform: [0, 1]}]\n").runs(), 4U);
  EXPECT_EQ(read("").runs(), 1U);
}

TEST_F(CampaignFile, AllFaultsAreToldWithTheirLines) {
  const std::string faults = faultsOf(
      "sed: 1\n"                                                                       // line 4
      "draws: 0\n"                                                                     // 5
      "factors:\n"                                                                     // 6
      "  - {name: a, key: board.a, uniform: [2, 1]}\n"                                 // 7
      "  - {name: b, key: board.b, log_uniform: [0, 1]}\n"                             // 8
      "  - {name: c, key: board.c}\n"                                                  // 9
      "  - {name: d, key: board.d, values: [1], uniform: [0, 1]}\n"                    // 10
      "  - {name: e, key: board.e, machine: belt.e, values: [1]}\n"                    // 11
      "  - {name: f, key: 'board.f[0]', values: [1]}\n"                                // 12
      "  - {name: a, key: board.g, values: [1, 1]}\n"                                  // 13
      "  - {name: h, key: board.h, normal: {mean: 0, sigma: 1, min: 9, max: 10}}\n");  // 14
  for (const char* part :
       {"c.yaml:4: sed: unknown key", "c.yaml:5: draws: 0 is outside", "c.yaml:7: factors[0].uniform",
        "c.yaml:8: factors[1].log_uniform", "c.yaml:9: factors[2].values: missing",
        "c.yaml:10: factors[3].uniform: only one of values, uniform", "c.yaml:11: factors[4].machine",
        "c.yaml:12: factors[5].key", "c.yaml:13: factors[6].name: is the name of another",
        "c.yaml:13: factors[6].values: '1' is given twice", "c.yaml:14: factors[7].normal.mean"})
    EXPECT_THAT(faults, HasSubstr(part));
}

TEST_F(CampaignFile, FaultsOfFaultsAreToldToo) {
  const auto of = [&](const std::string& fault) {
    return faultsOf("factors:\n  - name: f\n    faults:\n      - " + fault);
  };
  EXPECT_THAT(of("{name: s, size: [1]}\n"),
              HasSubstr("c.yaml:7: factors[0].faults[0].size: nothing is changed"));
  EXPECT_THAT(of("{name: s, changes: [{key: a.b, scale_by: 1}]}\n"), HasSubstr("needs a size"));
  EXPECT_THAT(of("{name: s, changes: [{key: a.b, set: '{size}'}]}\n"), HasSubstr("this fault has no size"));
  EXPECT_THAT(of("{name: s, size: [1], changes: [{key: a.b, set: 3}]}\n"),
              HasSubstr("none of them depends on the size"));
  EXPECT_THAT(of("{name: s, size: [fast], changes: [{key: a.b, scale_by: 1}]}\n"),
              HasSubstr("'fast' is no number"));
  EXPECT_THAT(of("{name: s, changes: [{key: a.b, set: 1, shift_by: 2}]}\n"), HasSubstr("give one of"));
  EXPECT_THAT(of("{name: s, changes: [{set: 1}]}\n"), HasSubstr("give either 'key'"));
  EXPECT_THAT(of("{name: s, changes: [{key: name, set: x}]}\n"), HasSubstr("the campaign sets it"));
  EXPECT_THAT(of("{name: s, changes: [{key: a.b, set: '[1, 2'}]}\n"), HasSubstr("is no value of YAML"));
  EXPECT_EQ(of("{name: s, size: {normal: {mean: 1, sigma: 0.1}}, changes: [{key: a.b, shift_by: 1}]}\n"), "");
}

TEST_F(CampaignFile, TwoThatSetOneKeyAreRefused) {
  EXPECT_THAT(
      faultsOf("set: {belt: {speed_mm_s: 1}}\nfactors: [{name: a, key: belt.speed_mm_s, values: [2]}]\n"),
      HasSubstr("is set by set too"));
  EXPECT_THAT(
      faultsOf(
          "factors: [{name: a, key: belt, values: [2]}, {name: b, key: belt.speed_mm_s, values: [2]}]\n"),
      HasSubstr("is set by factor 'a' too"));
  // The machine's keys are others than the scenario's, and faults of one factor never meet.
  EXPECT_EQ(
      faultsOf("factors: [{name: a, key: belt.x, values: [2]}, {name: b, machine: belt.x, values: [2]}]\n"),
      "");
  EXPECT_EQ(
      faultsOf(
          "factors:\n  - name: f\n    faults: [{name: s, changes: [{key: a.b, set: 1}]}, {name: t, changes: "
          "[{key: a.b, set: 2}]}]\n"),
      "");
}

TEST_F(CampaignFile, WhoSetsTheSeedHasIt) {
  EXPECT_FALSE(read("factors: [{name: seed, key: seed, values: [1, 2]}]\n").own_seeds);
  EXPECT_FALSE(read("set: {seed: 3}\n").own_seeds);
}

TEST_F(CampaignFile, AGridThatIsTooLargeIsRefused) {
  std::string values = "[0";
  for (int i = 1; i < 200; ++i) values += ", " + std::to_string(i);
  std::string factors = "factors:\n";
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h", "i"})
    factors += std::string("  - {name: ") + name + ", key: board." + name + ", values: " + values + "]}\n";
  EXPECT_THAT(faultsOf(factors), HasSubstr("more than 100000 runs"));
}

TEST_F(CampaignFile, ABaseMustBeThere) {
  EXPECT_THAT(faultsOf("title: x\n"), "");
  try {
    (void)readCampaign(
        folder_.write("d.yaml", "version: 1\nname: d e\nbase: [base.yaml, none.yaml, base.yaml]\n"));
    ADD_FAILURE() << "read";
  } catch (const base::ConfigError& e) {
    EXPECT_THAT(e.what(), HasSubstr("d.yaml:3: base: no such file 'none.yaml'"));
    EXPECT_THAT(e.what(), HasSubstr("d.yaml:3: base: 'base.yaml': another scenario has this file name"));
    EXPECT_THAT(e.what(), HasSubstr("d.yaml:2: name: names folders"));
  }
}

TEST_F(CampaignFile, TheShippedOnesAreRead) {
  for (const auto& entry : std::filesystem::directory_iterator(base::fixture("campaigns")))
    EXPECT_GT(readCampaign(entry.path()).runs(), 1U) << entry.path();
}

}  // namespace
}  // namespace kerfbench::campaign

// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/plan.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "hil/scenario/scenario.h"
#include "hil/suite/scenario_check.h"
#include "tests/docs/key_tables.h"
#include "tests/hil/suite/small_suite.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class SuitePlan : public testing::Test {
 protected:
  SuitePlan() {
    for (const char* name : {"a", "b", "c"}) small_.scenario(name);
  }
  [[nodiscard]] Plan read(const fs::path& image = {}) const {
    return readPlan(small_.plan(), {small_.folder() / "bin", image});
  }
  [[nodiscard]] std::string faults() const {
    return errorOf<base::ConfigError>([&] { return read(); });
  }
  [[nodiscard]] static std::vector<std::string> names(const Plan& plan) {
    std::vector<std::string> names;
    names.reserve(plan.runs.size());
    for (const PlannedRun& run : plan.runs) names.push_back(run.name);
    return names;
  }
  /// "plan.yaml:7: ", of the line with this text.
  [[nodiscard]] std::string at(const std::string& text) const {
    return fmt::format("{}:{}: ", small_.plan().string(), base::lineOf(base::contentOf(small_.plan()), text));
  }
  SmallSuite small_;
};

TEST_F(SuitePlan, PatternsAndSeedsBecomeRunsInTheirOrder) {
  small_.plan(
      "stop_after: 2\n"
      "runs:\n"
      "  - scenario: '[bc].yaml'\n"
      "    seeds: [7, 2]\n"
      "  - scenario: [a.yaml, b.yaml]\n");
  const Plan plan = read();
  EXPECT_THAT(names(plan), ElementsAre("b-seed-7", "b-seed-2", "c-seed-7", "c-seed-2", "a", "b"));
  EXPECT_EQ(plan.stop_after, 2U);
  EXPECT_EQ(plan.runs[1].choices.seed, 2U);
  EXPECT_FALSE(plan.runs[4].choices.seed.has_value());
  EXPECT_EQ(plan.runs[4].scenario, small_.folder() / "a.yaml");
  EXPECT_EQ(plan.runs[4].scenario_as_written, "a.yaml");
  EXPECT_TRUE(plan.runs[4].files.contains(small_.folder() / "a.yaml"));
  EXPECT_TRUE(plan.runs[4].files.contains(small_.folder() / "firmware/controller-native"));
}

TEST_F(SuitePlan, AnEntryTakesDefaultsAndAddsItsOwn) {
  small_.plan(
      "defaults: {tags: [nightly], seeds: [1], twin: fast, limits: {path_mm: 0.04, perforation: {limit_mm: "
      "1}}}\n"
      "runs:\n"
      "  - scenario: a.yaml\n"
      "    tags: [smoke, nightly]\n"
      "    twin: reference\n"
      "    limits: {path_mm: 0.03}\n"
      "  - scenario: b.yaml\n"
      "    seeds: []\n");
  const Plan plan = read();
  ASSERT_THAT(names(plan), ElementsAre("a-seed-1", "b"));
  EXPECT_THAT(plan.runs[0].tags, ElementsAre("nightly", "smoke"));
  EXPECT_EQ(plan.runs[0].choices.twin, "reference");
  EXPECT_EQ(plan.runs[1].choices.twin, "fast");
  EXPECT_EQ(plan.runs[0].limited_scenario,
            fmt::format("extends: \"{}\"\nchecks:\n  \"path_mm\": \"0.03\"\n  \"perforation\":\n"
                        "    \"limit_mm\": \"1\"\n",
                        (small_.folder() / "a.yaml").string()));
}

TEST_F(SuitePlan, LimitsAreThoseOfTheScenarioThatIsRun) {
  const std::map<std::string, std::string> limits{
      {"crease_depth.max", "0.5"}, {"crease_depth.min", "0.25"}, {"path_mm", "0.03"}};
  const fs::path file = small_.put("limited.yaml", limitedScenario(small_.folder() / "a.yaml", limits));
  const scenario::Scenario limited = scenario::readScenario(file, {small_.folder() / "firmware"});
  EXPECT_EQ(limited.limits.path_mm, 0.03);
  EXPECT_EQ(limited.limits.crease_depth.least, 0.25);
  EXPECT_EQ(limited.limits.crease_depth.most, 0.5);
  EXPECT_EQ(limited.name, "a");
}

TEST_F(SuitePlan, AllFaultsAreToldAtOnceWithTheirLines) {
  small_.scenario("broken", "seed: -3\n");
  small_.plan(
      "name: twice\n"
      "stop_after: -1\n"
      "defaults: {twin: slow}\n"
      "runs:\n"
      "  - scenario: nothing-*.yaml\n"
      "  - scenario: broken.yaml\n"
      "  - scenario: ./broken.yaml\n"
      "    seeds: [1, one, 1]\n"
      "  - scenario: a.yaml\n"
      "    limits: {path_mm: 99, no_such_limit: 1}\n"
      "  - scenario: b.yaml\n"
      "    expect: FAIL\n"
      "  - scenario: c.yaml\n"
      "    expect: FAIL\n"
      "    by: [gate_lagg]\n"
      "  - scenario: b.yaml\n"
      "    by: [path]\n"
      "    image: no-such-image\n"
      "  - senario: c.yaml\n");
  const std::string told = faults();
  EXPECT_THAT(told, HasSubstr(at("name: twice") + "name: given twice"));
  EXPECT_THAT(told, HasSubstr(at("stop_after") + "stop_after: -1 is outside"));
  EXPECT_THAT(told, HasSubstr(at("defaults") + "defaults.twin: 'slow' is none of: reference, fast"));
  EXPECT_THAT(told, HasSubstr(at("nothing-") + "runs[0].scenario: no such file 'nothing-*.yaml'"));
  EXPECT_THAT(told, HasSubstr("broken.yaml:3: seed: -3 is outside"));
  EXPECT_THAT(told, HasSubstr(at("[1, one, 1]") + "runs[2].seeds: 'one' is no whole number"));
  EXPECT_THAT(told, HasSubstr(at("[1, one, 1]") + "runs[2].seeds: 1 is given twice"));
  EXPECT_THAT(told, HasSubstr(at("no_such_limit") + "runs[3].limits: of a.yaml: "));
  EXPECT_THAT(told, HasSubstr("path_mm: 99 is outside"));
  EXPECT_THAT(told, HasSubstr("no_such_limit: unknown key"));
  EXPECT_THAT(told, HasSubstr("runs[4].by: missing: name the checks that must FAIL"));
  EXPECT_THAT(told, HasSubstr(at("gate_lagg") + "runs[5].by: 'gate_lagg' is no check"));
  EXPECT_THAT(told, HasSubstr(at("by: [path]") + "runs[6].by: is for runs that are expected not to PASS"));
  EXPECT_THAT(told, HasSubstr("runs[6].scenario: a run b is there already, of b.yaml"));
  EXPECT_THAT(told, HasSubstr("runs[6].image: no such file 'no-such-image'"));
  EXPECT_THAT(told, HasSubstr(at("senario:") + "runs[7].senario: unknown key"));
  const auto first = told.find("seed: -3");
  EXPECT_EQ(told.find("seed: -3", first + 1), std::string::npos) << "a scenario's fault is told once";
}

TEST_F(SuitePlan, AReleaseTakesThePlaceOfImagesWhereAPassIsExpected) {
  small_.put("own", "another image");
  small_.plan(
      "runs:\n"
      "  - scenario: a.yaml\n"
      "  - {scenario: b.yaml, expect: INVALID}\n"
      "  - {scenario: c.yaml, image: own, takes_release: false}\n"
      "  - {name: d, scenario: c.yaml, expect: FAIL, by: [path], takes_release: true}\n");
  const fs::path release = small_.put("new-release", "no program");
  const Plan plan = read(release);
  EXPECT_EQ(plan.runs[0].image, release);
  EXPECT_EQ(plan.runs[1].image, fs::path());
  EXPECT_EQ(plan.runs[2].image, small_.folder() / "own");
  EXPECT_EQ(plan.runs[3].image, release);
  // A text file is no native program: only those that it would run on say so.
  const std::string refused = errorOf<base::ConfigError>([&] {
    refuseUnfit(plan);
    return 0;
  });
  EXPECT_THAT(refused, HasSubstr(at("scenario: a.yaml") + "a: " + release.string()));
  EXPECT_THAT(refused, HasSubstr("takes_release: false"));
  EXPECT_THAT(refused, Not(HasSubstr("b.yaml")));
  EXPECT_THAT(refused, HasSubstr("d: " + release.string()));
}

TEST_F(SuitePlan, RealPinsAreKnownSinceTheyRunAlone) {
  small_.plan(fmt::format("runs: [{{scenario: a.yaml}}, {{scenario: '{}'}}]\n",
                          base::fixture("scenarios/pins/plate-on-pins.yaml").string()));
  const Plan plan = read();
  EXPECT_FALSE(plan.runs[0].on_real_pins);
  EXPECT_TRUE(plan.runs[1].on_real_pins);
}

TEST_F(SuitePlan, AFolderMayHaveTheCharactersOfPatterns) {
  const fs::path folder = small_.folder() / "old [1]*";
  fs::create_directories(folder);
  fs::copy_file(small_.folder() / "a.yaml", folder / "a.yaml");
  std::ofstream(folder / "plan.yaml") << "version: 1\nname: release\nruns: [{scenario: '?.yaml'}]\n";
  EXPECT_THAT(names(readPlan(folder / "plan.yaml", {small_.folder() / "bin", {}})), ElementsAre("a"));
}

TEST_F(SuitePlan, SelectionsLeaveOutTheRestAndKnowTheirWords) {
  small_.plan(
      "runs:\n"
      "  - {scenario: a.yaml, tags: [smoke]}\n"
      "  - {scenario: b.yaml, tags: [nightly], seeds: [1, 2]}\n"
      "  - {scenario: c.yaml}\n");
  const auto selected = [&](const Selection& selection) {
    Plan plan = read();
    const std::size_t left_out = select(plan, selection);
    EXPECT_EQ(left_out + plan.runs.size(), 4U);
    return names(plan);
  };
  EXPECT_THAT(selected({}), ElementsAre("a", "b-seed-1", "b-seed-2", "c"));
  EXPECT_THAT(selected({{"smoke", "nightly"}, {}}), ElementsAre("a", "b-seed-1", "b-seed-2"));
  EXPECT_THAT(selected({{}, {"*-2", "c"}}), ElementsAre("b-seed-2", "c"));
  EXPECT_THAT(selected({{"nightly"}, {"*-2", "c"}}), ElementsAre("b-seed-2"));
  EXPECT_THAT(selected({{}, {}, std::vector<std::string>{"c", "a"}}), ElementsAre("a", "c"));
  const auto refused = [&](const Selection& selection) {
    return errorOf<base::InputError>([&] { return selected(selection); });
  };
  EXPECT_THAT(refused({{"smok"}, {"x*"}}), testing::AllOf(HasSubstr("no run has the tag 'smok'"),
                                                          HasSubstr("no run has a name like 'x*'")));
  EXPECT_THAT(refused({{"smoke"}, {"c"}}), HasSubstr("no run is selected"));
  EXPECT_THAT(refused({{}, {}, std::vector<std::string>{"gone"}}),
              HasSubstr("no run is called 'gone' any more"));
}

TEST_F(SuitePlan, ItsPageHasEveryKey) {
  small_.put("own", "another image");
  small_.plan("runs: [{scenario: a.yaml, time_limit_s: 5, twin: fast, imperfections: ideal, image: own}]\n");
  std::set<std::string> keys;
  for (const auto& asked : read().keys) keys.insert(asked.key);
  keys.erase("defaults");
  keys.erase("runs");
  std::set<std::string> page;
  for (const auto& [key, row] : docs::tableRows("suite.md", "key")) page.insert(key);
  EXPECT_EQ(page.erase("extends"), 1U);  // Every file may have it.
  EXPECT_EQ(page, keys);
}

TEST_F(SuitePlan, AnotherVersionIsRefused) {
  small_.put("plan.yaml", "version: 2\nname: release\nruns: [{scenario: a.yaml}]\n");
  EXPECT_THAT(faults(), HasSubstr(at("version") + "version: this program reads version 1"));
}

}  // namespace
}  // namespace kerfbench::suite

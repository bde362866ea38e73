// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/identity.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Identity : public testing::Test {
 protected:
  Identity() {
    bench_.images = {folder_.path()};
    bench_.programs = {folder_.write("kerfbench", "a program"), folder_.path() / "not-there"};
    (void)folder_.write("controller-native", "a release");
    (void)folder_.write(
        "base.yaml",
        "extends: " + base::fixture("scenarios/native/label-on-belt.yaml").string() + "\nname: base\n");
  }
  Campaign campaign(const std::string& factors = "[{name: v, key: belt.speed_mm_s, values: [30, 40]}]") {
    return readCampaign(
        folder_.write("c.yaml", "version: 1\nname: c\nbase: base.yaml\nfactors: " + factors + "\n"));
  }
  Prepared made(const std::string& out) { return prepare(campaign(), folder_.path() / out, bench_); }
  std::string refusal(const std::string& out) {
    try {
      (void)made(out);
    } catch (const base::InputError& e) {
      return e.what();
    }
    return {};
  }
  void append(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name, std::ios::app) << text;
  }

  base::TempFolder folder_;
  BenchFiles bench_;
};

TEST_F(Identity, ItIsTheSameWhereverTheResultsLieAndHoweverOftenItIsAsked) {
  const Prepared one = made("one"), two = made("deep/in/two"), again = made("one");
  EXPECT_EQ(one.identity, two.identity);
  EXPECT_EQ(one.identity, again.identity);
  EXPECT_TRUE(fs::exists(one.scenarioOf(1)));
  const KnownCampaign known = knownCampaign(one.folder);
  EXPECT_EQ(known.prepared.identity, one.identity);
  EXPECT_EQ(known.runs, 2U);
  EXPECT_EQ(known.name, "c");
}

TEST_F(Identity, AnyFileThatTheRunsDependOnIsInIt) {
  const std::string identity = made("one").identity;
  append("controller-native", "!");
  EXPECT_NE(made("two").identity, identity);
  EXPECT_THAT(refusal("one"), HasSubstr("controller-native has changed since"));
  (void)folder_.write("controller-native", "a release");
  EXPECT_EQ(made("three").identity, identity);
  append("kerfbench", "!");
  EXPECT_THAT(refusal("one"), HasSubstr("kerfbench has changed since"));
  (void)folder_.write("kerfbench", "a program");
  append("base.yaml", "# a remark\n");
  EXPECT_THAT(refusal("one"), HasSubstr("base.yaml has changed since"));
  EXPECT_NE(made("four").identity, identity);
}

TEST_F(Identity, AFolderOfAnotherCampaignIsRefused) {
  (void)made("one");
  const Campaign other = campaign("[{name: v, key: belt.speed_mm_s, values: [30, 50]}]");
  EXPECT_THROW((void)prepare(other, folder_.path() / "one", bench_), base::InputError);
  (void)folder_.write("letters.txt", "");
  try {
    (void)prepare(other, folder_.path(), bench_);
    ADD_FAILURE() << "prepared";
  } catch (const base::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("which is no campaign's"));
  }
  EXPECT_THROW((void)knownCampaign(folder_.path() / "nowhere"), base::InputError);
}

TEST_F(Identity, AFaultThatManyRunsShareIsToldOnceAndNothingIsRun) {
  const Campaign wrong = campaign(
      "[{name: v, key: belt.sped_mm_s, values: [30, 40]}, {name: t, key: twin, values: [fast, slow]}, "
      "{name: d, machine: laser.gate_delay_us, values: [1, -1]}]");
  try {
    (void)prepare(wrong, folder_.path() / "out", bench_);
    ADD_FAILURE() << "prepared";
  } catch (const base::ConfigError& e) {
    const std::string what = e.what();
    EXPECT_THAT(what, HasSubstr("000000.yaml:"));
    EXPECT_THAT(what, HasSubstr("belt.sped_mm_s: unknown key"));
    EXPECT_EQ(what.find("sped_mm_s: unknown"), what.rfind("sped_mm_s: unknown"));
    EXPECT_THAT(what, HasSubstr("'slow' is none of"));
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "out" / "campaign.json"));
  // The same folder does for the mended file.
  EXPECT_NO_THROW((void)made("out"));
}

}  // namespace
}  // namespace kerfbench::campaign

// SPDX-License-Identifier: Apache-2.0
// A machine as built: sampled by preset and seed, described in the report, the same again by the same seed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;

class Imperfections : public testing::Test {
 protected:
  // Runs the quickest job there is: a plate at rest.
  [[nodiscard]] nlohmann::json run(const std::string& name, const std::string& options) const {
    const auto result = kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}' {}", plate(),
                                              (scratch_.path() / name).string(), options));
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1 || result.exit_code == 4) << result.output;
    return verdictOf(scratch_.path() / name / "line-ok-plate");
  }
  static std::string plate() { return fixture("scenarios/line-ok/plate.yaml").string(); }
  ScratchFolder scratch_;
};

TEST_F(Imperfections, AreDrawnBySeedAndToldWithTheirUnits) {
  const auto ideal = run("ideal", "");
  EXPECT_EQ(ideal.at("model").at("imperfections"), "ideal");
  EXPECT_EQ(ideal.at("model").at("twin"), "reference");
  EXPECT_TRUE(ideal.at("model").at("sampled").empty());
  EXPECT_TRUE(ideal.at("model").at("lost_steps").empty());

  const auto one = run("one", "--imperfections dynamic --seed 4");
  const auto& drawn = one.at("model").at("sampled");
  EXPECT_EQ(one.at("model").at("imperfections"), "dynamic");
  ASSERT_GT(drawn.size(), 20U);
  for (const auto& value : drawn) {
    EXPECT_NE(value.at("value").get<double>(), 0.0) << value;
    EXPECT_FALSE(value.at("unit").get<std::string>().empty()) << value;
  }
  const std::string page = textOf(scratch_.path() / "one" / "line-ok-plate" / "latest" / "report.html");
  EXPECT_THAT(page, HasSubstr("Imperfections <b>dynamic</b>, seed 4, model <b>reference</b>"));
  EXPECT_THAT(page, HasSubstr("<td>" + drawn[0].at("name").get<std::string>() + "<td"));

  // A different machine cuts differently; the same machine, from its recording, in the same manner.
  EXPECT_NE(one.at("digest"), ideal.at("digest"));
  const auto replay = kerfbench(fmt::format(
      "replay '{}' --scenario '{}' --no-pictures --imperfections dynamic --seed 4 --results-dir '{}'",
      (scratch_.path() / "one" / "line-ok-plate" / "latest" / "pins.vcd").string(), plate(),
      (scratch_.path() / "again").string()));
  const auto again = verdictOf(scratch_.path() / "again" / "line-ok-plate-replay");
  EXPECT_EQ(again.at("digest"), one.at("digest")) << replay.output;
  EXPECT_EQ(again.at("model").at("sampled"), drawn);
}

TEST_F(Imperfections, TheFastModelComesToTheSameVerdict) {
  const auto reference = run("reference", "");
  const auto fast = run("fast", "--twin fast");
  EXPECT_EQ(fast.at("model").at("twin"), "fast");
  EXPECT_EQ(fast.at("verdict"), reference.at("verdict"));
  ASSERT_EQ(fast.at("checks").size(), reference.at("checks").size());
  for (std::size_t i = 0; i < fast.at("checks").size(); ++i) {
    const auto& a = reference.at("checks")[i];
    const auto& b = fast.at("checks")[i];
    EXPECT_EQ(a.at("verdict"), b.at("verdict")) << a.at("name");
    if (a.at("unit") != "mm" || a.at("value").is_null()) continue;
    EXPECT_NEAR(a.at("value").get<double>(), b.at("value").get<double>(), 0.0005) << a.at("name");
  }
}

TEST_F(Imperfections, WhatIsNoPresetIsAWrongCommandLine) {
  EXPECT_EQ(kerfbench(fmt::format("run '{}' --imperfections some", plate())).exit_code, 64);
  EXPECT_EQ(kerfbench(fmt::format("run '{}' --twin slow", plate())).exit_code, 64);
}

}  // namespace
}  // namespace kerfbench::test

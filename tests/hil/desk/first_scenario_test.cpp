// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/first_scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"
#include "hil/desk/job_plan.h"
#include "hil/desk/scenario_check.h"
#include "hil/desk/scenario_copy.h"
#include "hil/dieline/read.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Pair {
  const char* drawing;
  const char* machine;
};
void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.drawing << " on " << pair.machine; }

class FirstScenario : public testing::TestWithParam<Pair> {};

TEST_P(FirstScenario, FitsWithoutAWordOfTheUsers) {
  const base::TempFolder temp;
  const fs::path out = temp.path() / "mine.yaml";
  const std::string text = firstScenario({base::fixture(std::string("dielines/") + GetParam().drawing),
                                          base::fixture(std::string("machines/") + GetParam().machine), out},
                                         kRequest);
  const json check = json::parse(checkJson({text, out}, kRequest));
  EXPECT_TRUE(check["fits"]) << check["issues"] << text;
  EXPECT_EQ(check["name"], "mine");
  const json plan = json::parse(planJson({text, out}, std::nullopt, kRequest));
  EXPECT_TRUE(plan["fits"]) << plan["issues"] << text;
}

INSTANTIATE_TEST_SUITE_P(Shipped, FirstScenario,
                         testing::Values(Pair{"label-60x40.dxf", "two-mirror.yaml"},
                                         Pair{"label-60x40.svg", "two-mirror.yaml"},
                                         Pair{"button.dxf", "two-mirror-slow.yaml"},
                                         Pair{"coupon-perforated.dxf", "two-mirror.yaml"},
                                         Pair{"label-60x40.dxf", "strip-gantry.yaml"},
                                         Pair{"tuck-end-carton.dxf", "f-theta-300.yaml"},
                                         Pair{"label-60x40.dxf", "two-mirror-mcs51.yaml"},
                                         Pair{"label-60x40.dxf", "two-mirror-stm32.yaml"}),
                         [](const auto& tested) { return std::to_string(tested.index); });

std::string line(const std::string& layer, double x0, double y0, double x1, double y1) {
  return fmt::format("0\nLINE\n8\n{}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", layer, x0, y0, x1, y1);
}

TEST(FirstScenarioText, LayersWithoutAUsualNameAreThereToBeDecided) {
  const base::TempFolder temp;
  const fs::path drawing =
      temp.write("odd: name.dxf", "0\nSECTION\n2\nENTITIES\n" + line("Stanzkontur: A.B", 0, 300, 30, 300) +
                                      line("Stanzkontur: A.B", 30, 300, 30, 340) +
                                      line("Masse", 0, 320, 10, 320) + "0\nENDSEC\n0\nEOF\n");
  const fs::path out = temp.path() / "my job.yaml";
  const std::string text = firstScenario({drawing, base::fixture("machines/two-mirror.yaml"), out}, kRequest);
  const json check = json::parse(checkJson({text, out}, kRequest));
  EXPECT_TRUE(check["fits"]) << check["issues"] << text;
  EXPECT_EQ(check["values"]["layers"]["Stanzkontur: A.B"], "cut");
  EXPECT_EQ(check["values"]["layers"]["Masse"], "ignore");
  EXPECT_EQ(check["name"], "my-job");
  EXPECT_THAT(text, testing::HasSubstr("No usual name"));
  // Drawn far off, it is in the field all the same.
  EXPECT_TRUE(json::parse(planJson({text, out}, std::nullopt, kRequest))["fits"]) << text;
}

/// The usual release makes 31 steps in 0.8 ms: 72 mm/s on this machine, at which its spot camera sees
/// nothing.
TEST(FirstScenarioText, FineMirrorsGetTheReleaseThatIsQuickEnough) {
  const base::TempFolder temp;
  const fs::path out = temp.path() / "fine.yaml";
  const auto issues = [&](const std::string& text) {
    const json plan = json::parse(planJson({text, out}, std::nullopt, kRequest));
    EXPECT_TRUE(plan["fits"]) << plan["issues"];
    return plan["issues"];
  };
  const std::string text = firstScenario(
      {base::fixture("dielines/label-60x40.dxf"), base::fixture("machines/two-mirror-300.yaml"), out},
      kRequest);
  EXPECT_THAT(text, testing::HasSubstr("controller-native-galvo"));
  EXPECT_TRUE(issues(text).empty()) << issues(text);
  // As on a page where somebody chooses this machine for a job of another: told before Start, with what to
  // change.
  const json told = issues(base::replaced(text, "image: controller-native-galvo, mcu: native, baud: 2000000",
                                          "image: controller-native, mcu: native"));
  ASSERT_EQ(told.size(), 2U) << told;
  EXPECT_EQ(told[0]["severity"], "warning");
  EXPECT_THAT(told[0]["message"].get<std::string>(),
              testing::AllOf(testing::HasSubstr("of the 300 mm/s that are asked"),
                             testing::HasSubstr("choose a release with quicker steps")));
  EXPECT_THAT(told[1]["message"].get<std::string>(),
              testing::AllOf(testing::HasSubstr("of 255 grey values"), testing::HasSubstr("mark faster")));
}

TEST(FirstScenarioText, WhatCannotBeReadIsRefused) {
  const base::TempFolder temp;
  const fs::path machine = base::fixture("machines/two-mirror.yaml");
  EXPECT_THROW((void)firstScenario({temp.path() / "none.dxf", machine, temp.path() / "s.yaml"}, kRequest),
               dieline::DielineError);
  const fs::path empty = temp.write("empty.dxf", "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n");
  EXPECT_THROW((void)firstScenario({empty, machine, temp.path() / "s.yaml"}, kRequest), base::InputError);
}

TEST(CopiedScenario, LeadsToTheSameFilesFromItsNewPlace) {
  const base::TempFolder temp;
  for (const char* name :
       {"label-on-belt.yaml", "native/label-on-belt.yaml", "native/button.yaml", "native/short-lines.yaml"}) {
    const fs::path from = base::fixture(std::string("scenarios/") + name);
    const fs::path to = temp.path() / "deeper" / "copy-1.yaml";
    const std::string text = base::contentOf(from);
    const std::string copy = copiedScenario({text, from}, to, kRequest);
    const json before = json::parse(checkJson({text, from}, kRequest));
    const json after = json::parse(checkJson({copy, to}, kRequest));
    EXPECT_TRUE(after["fits"]) << after["issues"] << copy;
    EXPECT_EQ(after["name"], "copy-1");
    EXPECT_EQ(after["drawing"]["file"], before["drawing"]["file"]);
    EXPECT_EQ(after["machine"]["file"], before["machine"]["file"]);
  }
}

}  // namespace
}  // namespace kerfbench::desk

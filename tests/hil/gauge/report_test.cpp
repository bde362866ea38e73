// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "hil/gauge/gauge_report.h"
#include "tests/hil/report/page_checks.h"

namespace kerfbench::gauge {
namespace {

GaugeResult someResult() {
  GaugeResult result;
  result.kerf_cases = 3;
  GaugeSection s;
  s.preset = "static";
  Reading r{"worst <of> all", 0.0312345678, 0.001, 0.031};
  s.coverage = {coverageOf(r.quantity, {{"static-good-1", r}})};
  s.worst = {{"static-good-1", FaultKind::kBump, inspect::Verdict::kPass, 0.031, 0.0312, 0.001},
             {"static-bad-2", FaultKind::kWave, inspect::Verdict::kFail, 0.07, 0.0702, 0.001}};
  s.joints = {{"static-bad-3", FaultKind::kEnd, inspect::Verdict::kPass, 0.07, std::nan(""), std::nan("")}};
  s.repeat_mm = {1e-4, -2e-4, 3e-4};
  s.repeat = typeOne(s.repeat_mm, kTolerance_mm);
  s.kinds = {{FaultKind::kBump, {{inspect::Verdict::kFail, 2}}, {}, 0.0521, 60}};
  s.field = {{{2.5, 2.5}, {1e-4, 0.0}, 1e-5, 20}};
  s.wrong = {"static-bad-3: PASS with a true deviation of 70.0 µm (end)"};
  result.claims = {{"static", "a < b", "3", "≤ 2", Claim::State::kFails}};
  result.sections = {s};
  return result;
}

const GaugeFacts kFacts{"m", "kerf & co", "spot", "./bench gauge --seed 1", "0.1.0"};

TEST(GaugeJson, HoldsClaimsAndCases) {
  const auto json = nlohmann::json::parse(gaugeJson(someResult(), {}, kFacts));
  EXPECT_FALSE(json.at("holds").get<bool>());
  EXPECT_EQ(json.at("claims").at(0).at("state"), "fails");
  EXPECT_EQ(json.at("sections").at(0).at("coverage").at(0).at("hits"), 1);
  EXPECT_EQ(json.at("sections").at(0).at("worst_deviation").at(1).at("fault"), "wave");
  EXPECT_TRUE(json.at("sections").at(0).at("joint_faults").at(0).at("measured_mm").is_null());
  EXPECT_TRUE(json.at("sections").at(0).at("grr").is_null());
}

TEST(GaugeHtml, IsOnePageThatNeedsNothingElse) {
  const std::string html = gaugeHtml(someResult(), {}, kFacts);
  EXPECT_EQ(report::test::outsideReferences(html), "");
  EXPECT_EQ(report::test::unclosedElements(html), "");
  EXPECT_NE(html.find("DOES NOT HOLD"), html.npos);
  EXPECT_NE(html.find("a &lt; b"), html.npos);
  EXPECT_NE(html.find("worst &lt;of&gt; all"), html.npos);
  EXPECT_NE(html.find("kerf &amp; co"), html.npos);
  EXPECT_EQ(report::test::numberFaults(html), "");
}

TEST(GaugeHtml, OfNothingIsStillAPage) {
  GaugeResult empty;
  GaugeSection s;
  s.preset = "dynamic";
  empty.sections = {s};
  const std::string html = gaugeHtml(empty, {}, kFacts);
  EXPECT_NE(html.find("</html>"), html.npos);
  EXPECT_EQ(report::test::numberFaults(html), "");
}

}  // namespace
}  // namespace kerfbench::gauge

// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/yaml_reader.h"
#include "hil/desk/desk_issue.h"
#include "hil/dieline/read.h"
#include "hil/run/controller_fit.h"
#include "hil/scenario/case.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json check(const std::string& text, const fs::path& file) {
  return json::parse(checkJson({text, file}, kRequest));
}

/// What a run says of a scenario before it begins; nothing where it would begin.
std::optional<std::string> refusalOfRun(const fs::path& file) {
  try {
    const scenario::Case whole = scenario::readCase(file, {kBuild / "firmware"});
    run::refuseUnfitController(whole, kBuild / "bin");
    return std::nullopt;
  } catch (const base::ConfigError& error) {
    return error.what();
  } catch (const dieline::DielineError& error) {
    return error.what();
  }
}

TEST(ScenarioCheck, FitsWhatARunTakesAndNothingElse) {
  int good = 0, bad = 0;
  for (const auto& entry : fs::recursive_directory_iterator(base::fixture("scenarios"))) {
    if (entry.path().extension() != ".yaml") continue;
    const json answer = check(base::contentOf(entry.path()), entry.path());
    const auto refusal = refusalOfRun(entry.path());
    EXPECT_EQ(answer["fits"], !refusal.has_value()) << entry.path() << "\n"
                                                    << refusal.value_or("") << "\n"
                                                    << answer["issues"];
    (refusal ? bad : good) += 1;
    if (refusal) continue;
    for (const json& issue : answer["issues"])
      EXPECT_THAT(issue["message"].get<std::string>(),
                  testing::HasSubstr("does not say how long one unit is"))
          << entry.path() << issue;
    EXPECT_EQ(answer["drawing"]["shown"], answer["drawing"]["count"]);
    EXPECT_FALSE(answer["machine"]["name"].get<std::string>().empty());
    EXPECT_GT(answer["values"].size(), 10U);
  }
  EXPECT_GT(good, 60);
}

class FaultyText : public testing::Test {
 protected:
  FaultyText() : text_(base::contentOf(base::fixture("scenarios/native/label-on-belt.yaml"))) {}
  /// Check of the shipped file, changed.
  json changed(const std::string& from, const std::string& to) {
    text_ = base::replaced(text_, from, to);
    return check(text_, base::fixture("scenarios/native/label-on-belt.yaml"));
  }
  std::string text_;
};

TEST_F(FaultyText, EachFaultHasItsPlaceAndTheDrawingIsThereAllTheSame) {
  text_ += "chekcs: {path_mm: 1}\n";
  text_ += "seed: -5\n";
  const json answer = check(text_, base::fixture("scenarios/native/label-on-belt.yaml"));
  EXPECT_FALSE(answer["fits"]);
  ASSERT_EQ(answer["issues"].size(), 2U) << answer["issues"];
  for (const json& issue : answer["issues"]) {
    const std::string key = issue["key"];
    EXPECT_EQ(issue["line"], base::lineOf(text_, key + ":")) << issue;
    EXPECT_EQ(issue["column"], 1);
    EXPECT_EQ(issue["file"], "");
    EXPECT_EQ(issue["severity"], "error");
  }
  EXPECT_FALSE(answer["drawing"]["entities"].empty());
  EXPECT_EQ(answer["values"]["seed"], -5);
  EXPECT_THAT(answer["own"].get<std::vector<std::string>>(), testing::Contains("seed"));
}

TEST_F(FaultyText, TextThatIsNoYamlHasLineAndColumn) {
  const json answer = check("name: a\nbelt: {speed_mm_s: [1\nseed: 1\n", base::fixture("scenarios/x.yaml"));
  ASSERT_EQ(answer["issues"].size(), 1U);
  EXPECT_GT(answer["issues"][0]["line"], 1);
  EXPECT_GT(answer["issues"][0]["column"], 0);
  EXPECT_TRUE(answer["drawing"].is_null());
}

TEST_F(FaultyText, FaultsOfOtherFilesNameThem) {
  const base::TempFolder temp;
  const fs::path machine =
      temp.write("m.yaml", "extends: " + base::fixture("machines/two-mirror.yaml").string() +
                               "\nname: m\ncontroller: {throw_mm: 3}\n");
  const fs::path drawing = temp.write(
      "d.dxf",
      "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nUNKNOWN LAYER\n10\n0\n20\n0\n11\n5\n21\n5\n0\nENDSEC\n0\nEOF\n");
  const std::string text = "extends: " + base::fixture("scenarios/native/label-on-belt.yaml").string() +
                           "\nname: other\nmachine: m.yaml\ndieline: d.dxf\n";
  const json answer = json::parse(checkJson({text, temp.path() / "new.yaml"},
                                            {.bin_dir = kBuild / "bin", .name_of = [](const fs::path& file) {
                                               return "shown/" + file.filename().string();
                                             }}));
  ASSERT_EQ(answer["issues"].size(), 2U) << answer["issues"];
  EXPECT_EQ(answer["issues"][0]["file"], "shown/m.yaml");
  EXPECT_EQ(answer["issues"][0]["line"], 3);
  EXPECT_EQ(answer["issues"][0]["key"], "controller.throw_mm");
  EXPECT_EQ(answer["issues"][1]["file"], "shown/d.dxf");
  EXPECT_THAT(answer["issues"][1]["message"].get<std::string>(), testing::HasSubstr("UNKNOWN LAYER"));
}

TEST_F(FaultyText, NamesOfADrawingStayText) {
  const base::TempFolder temp;
  const std::string name = "<script>alert('x')</script>\"&\xff";
  (void)temp.write("d.dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n" + name +
                                "\n10\n-20\n20\n0\n11\n-5\n21\n5\n0\nLINE\n8\n" + name +
                                "\n10\n-20\n20\n0\n11\n-5\n21\n5\n0\nENDSEC\n0\nEOF\n");
  const std::string text = "extends: " + base::fixture("scenarios/native/label-on-belt.yaml").string() +
                           "\nname: other\ndieline: {file: d.dxf, unit: mm}\nlayers: {\"*\": cut}\n";
  const json answer = check(text, temp.path() / "new.yaml");
  ASSERT_FALSE(answer["drawing"].is_null()) << answer["issues"];
  const json& drawing = answer["drawing"];
  EXPECT_EQ(drawing["layers"][0]["name"].get<std::string>().substr(0, 10), name.substr(0, 10));
  EXPECT_EQ(drawing["svg"].get<std::string>().find("script"), std::string::npos);
  EXPECT_FALSE(answer["fits"]);
  ASSERT_EQ(drawing["findings"].size(), 1U) << drawing["findings"];
  EXPECT_EQ(drawing["findings"][0]["kind"], "duplicate");
  EXPECT_EQ(drawing["findings"][0]["entities"], json({1, 0}));
  EXPECT_GT(drawing["findings"][0]["line"], 0);
}

TEST_F(FaultyText, ADrawingOfAHundredThousandLinesIsAnswered) {
  const base::TempFolder temp;
  std::string dxf = "0\nSECTION\n2\nENTITIES\n";
  for (int i = 0; i < 100'001; ++i)
    dxf += fmt::format("0\nLINE\n8\nCUT\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", i % 317, i / 317, i % 317 + 0.4,
                       i / 317 + 0.3);
  (void)temp.write("d.dxf", dxf + "0\nENDSEC\n0\nEOF\n");
  const std::string text = "extends: " + base::fixture("scenarios/native/label-on-belt.yaml").string() +
                           "\nname: other\ndieline: {file: d.dxf, unit: mm}\n";
  int told = 0;
  const json answer = json::parse(
      checkJson({text, temp.path() / "new.yaml"},
                {.bin_dir = kBuild / "bin", .progress = [&](double, const std::string&) { ++told; }}));
  const json& drawing = answer["drawing"];
  ASSERT_FALSE(drawing.is_null()) << answer["issues"];
  EXPECT_EQ(drawing["count"], 100'001);
  EXPECT_EQ(drawing["shown"], kMostEntitiesShown);
  EXPECT_EQ(drawing["layers"][0]["count"], 100'001);
  EXPECT_THAT(drawing["notes"].dump(), testing::HasSubstr("100000 of 100001"));
  EXPECT_GT(told, 0);
}

TEST(DeskIssue, PlacesOfKeysInAText) {
  const std::string text = "a: 1\nbelt:\n  speed_mm_s: 60\nchecks: {path_mm: 1}\n";
  EXPECT_EQ(placeOfKey(text, "belt.speed_mm_s").line, 3);
  EXPECT_EQ(placeOfKey(text, "belt.speed_mm_s").column, 3);
  EXPECT_EQ(placeOfKey(text, "checks.path_mm").column, 10);
  EXPECT_EQ(placeOfKey(text, "belt.lead_s").line, 2);
  EXPECT_EQ(placeOfKey(text, "print.units").line, 0);
}

TEST(DeskIssue, LinesOfAnExceptionBecomeIssues) {
  const base::TempFolder temp;
  const fs::path odd = temp.write("a: 3: b.yaml", "");
  const ScenarioText scenario{"x: 1\nbelt: {drive: line}\n", "/nowhere/s.yaml"};
  const auto issues = issuesIn(
      odd.string() + ":7: board.x: is no\nmore of it\n/nowhere/s.yaml: belt.drive: no feed\nwithout a file",
      scenario);
  ASSERT_EQ(issues.size(), 2U);
  EXPECT_EQ(issues[0].file, odd);
  EXPECT_EQ(issues[0].line, 7);
  EXPECT_EQ(issues[0].key, "board.x");
  EXPECT_EQ(issues[0].message, "is no\nmore of it");
  EXPECT_TRUE(issues[1].file.empty());
  EXPECT_EQ(issues[1].line, 2);
  EXPECT_EQ(issues[1].column, 8);
  EXPECT_EQ(issues[1].message, "no feed\nwithout a file");
}

}  // namespace
}  // namespace kerfbench::desk

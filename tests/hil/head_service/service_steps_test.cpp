// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/service_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/base/yaml_reader.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/report/page_checks.h"

namespace kerfbench::head_service {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Steps : public testing::Test {
 protected:
  Steps() {
    order_.job.name = "1-grid";
    order_.job.marks = {{3, {0.0, 0.0}}, {4, {5.0, 0.0}}};
    steps_.follow(stepsAhead());
  }
  /// "1-grid.cut now", …
  [[nodiscard]] std::vector<std::string> states() const {
    std::vector<std::string> all;
    const auto json = nlohmann::json::parse(steps_.json());
    for (const auto& step : json.at("steps"))
      all.push_back(step.at("id").get<std::string>() + " " + step.at("state").get<std::string>());
    return all;
  }

  base::TempFolder temp_;
  SheetOrder order_;
  ServiceSteps steps_{
      {"calibrate head", "m <1>", "kerf-7", "2026-11-22", "./bench calibrate head --by-hand", "1.0"},
      temp_.path()};
};

TEST_F(Steps, OfASheetThatIsWantedBeginWithCuttingIt) {
  steps_.wanted(order_, {"Lay it.", "Cut it."}, {"Photograph it."}, {});
  EXPECT_THAT(states(), ElementsAre("1-grid.cut now", "1-grid.photograph later", "1-grid.load later",
                                    "1-grid.found later", "verify later", "table later", "controller later"));
  const auto json = nlohmann::json::parse(steps_.json());
  EXPECT_EQ(json.at("headline"), "Cut sheet 1-grid: 2 marks");
  EXPECT_EQ(json.at("verdict"), "");
  EXPECT_THAT(json.at("steps")[0].at("text"), ElementsAre("Lay it.", "Cut it."));
  EXPECT_EQ(json.at("steps")[0].at("files")[0].at("path"), "1-grid/print.pdf");
}

TEST_F(Steps, WithSomePicturesAskForTheOthers) {
  steps_.wanted(order_, {"Cut it."}, {"Photograph it."}, {"Of the 9 pictures 2 are missing."});
  EXPECT_THAT(states(), testing::Contains("1-grid.load now"));
  EXPECT_THAT(states(), testing::Contains("1-grid.photograph done"));
  const auto json = nlohmann::json::parse(steps_.json());
  EXPECT_THAT(json.at("steps")[2].at("wrong"), ElementsAre("Of the 9 pictures 2 are missing."));
  EXPECT_THAT(json.at("headline").get<std::string>(), HasSubstr("Something is wrong"));
}

TEST_F(Steps, TellWhatWasFoundAndWhatIsWrong) {
  MeasuredSheet sheet;
  sheet.marks = {{order_.job.marks[0], {0.0, 0.003}, Eigen::Matrix2d::Identity()}};
  sheet.missing = 1;
  sheet.remarks = {"mark 4 is missing"};
  steps_.measured(order_, sheet);
  order_.job.name = "1-verify-1";
  order_.table.reset();
  steps_.refused(order_, "pictures: job 1-verify-1:\n  another job's sheet");
  const auto json = nlohmann::json::parse(steps_.json()).at("steps");
  EXPECT_THAT(json[3].at("found"),
              ElementsAre("1 of 2 marks were found; 0 false.",
                          "The beam was off by 0.0030 mm at most, 0.0030 mm RMS.", "mark 4 is missing"));
  EXPECT_EQ(json[7].at("id"), "1-verify-1.found");
  EXPECT_EQ(json[7].at("state"), "now");
  EXPECT_THAT(json[7].at("wrong"), ElementsAre("pictures: job 1-verify-1:", "another job's sheet"));
}

TEST_F(Steps, HaveAPageThatNeedsNothingElseAndThatPaperCanTake) {
  steps_.wanted(order_, {"Lay it <so>."}, {"Photograph it."}, {});
  const std::string html = steps_.html();
  EXPECT_EQ(report::test::unclosedElements(html), "");
  EXPECT_EQ(report::test::numberFaults(html), "");
  EXPECT_THAT(html, HasSubstr("Lay it &lt;so&gt;."));
  EXPECT_THAT(html, HasSubstr("<div class=big>Step 1 of 7</div>"));
  EXPECT_THAT(html, HasSubstr("<input type=checkbox id='tick-1-grid.cut'>"));
  EXPECT_THAT(html, HasSubstr("href='1-grid/print.pdf'"));
  EXPECT_THAT(html, HasSubstr("<div class=sign>"));
}

TEST_F(Steps, AreReadBackFromTheResultsAndNothingElseIs) {
  steps_.wanted(order_, {"Cut it."}, {"Photograph it."}, {});
  steps_.write();
  EXPECT_EQ(readSteps(temp_.path()), steps_.json());
  const auto refusal = [&](const std::string& text) -> std::string {
    std::ofstream(temp_.path() / "steps.json") << text;
    try {
      readSteps(temp_.path());
    } catch (const base::ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("{"), HasSubstr("is not what"));
  EXPECT_THAT(refusal(R"({"steps": 3})"), HasSubstr("is not what"));
  EXPECT_THAT(refusal(R"({"version": 9, "steps": []})"), HasSubstr("this program reads version 1"));
  std::filesystem::remove(temp_.path() / "steps.json");
  EXPECT_THROW(readSteps(temp_.path()), base::ConfigError);
}

}  // namespace
}  // namespace kerfbench::head_service

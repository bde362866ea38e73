// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/sheet_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "hil/base/input_error.h"
#include "hil/desk/first_scenario.h"
#include "hil/desk/job_plan.h"
#include "hil/desk/place_anew.h"
#include "hil/desk/scenario_check.h"
#include "hil/desk/scenario_edit.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// 220 x 150 units, without a word on what a unit is, and with one on the sheet.
const char* const kBare =
    "<svg xmlns='http://www.w3.org/2000/svg' width='240' height='170'>\n"
    "<rect x='10' y='10' width='220' height='150' fill='none' stroke='black'/>\n<text x='5' "
    "y='5'>A</text>\n</svg>\n";

class Placing : public testing::Test {
 protected:
  Placing()
      : drawing_(temp_.write("bare.svg", kBare)),
        out_(temp_.path() / "bare.yaml"),
        text_(firstScenario({drawing_, base::fixture("machines/two-mirror.yaml"), out_}, kRequest)) {}
  [[nodiscard]] json check(const std::string& text) const {
    return json::parse(checkJson({text, out_}, kRequest));
  }
  [[nodiscard]] json plan(const std::string& text) const {
    return json::parse(planJson({text, out_}, std::nullopt, kRequest));
  }
  [[nodiscard]] std::string placed(const std::string& text,
                                   const std::optional<std::string>& unit = {}) const {
    return json::parse(placeJson({text, out_}, unit, kRequest))["text"];
  }
  base::TempFolder temp_;
  fs::path drawing_, out_;
  std::string text_;
};

TEST_F(Placing, ADrawingWithoutAUnitIsAskedFor) {
  const json answer = check(text_);
  EXPECT_EQ(answer["drawing"]["unsaid_unit"], json::parse(R"({"line": 1, "taken_mm": 1.0, "name": "mm"})"));
  ASSERT_EQ(answer["issues"].size(), 2U) << answer["issues"];
  EXPECT_EQ(answer["issues"][0]["severity"], "warning");
  EXPECT_EQ(answer["issues"][0]["line"], 1);
  EXPECT_THAT(answer["issues"][0]["message"].get<std::string>(), HasSubstr("220.0 x 150.0 mm"));
  EXPECT_EQ(answer["issues"][1]["line"], 3);
  EXPECT_THAT(answer["issues"][1]["message"].get<std::string>(), HasSubstr("text: 1 ignored"));
  EXPECT_EQ(answer["issues"][1]["file"], drawing_.string());
  EXPECT_TRUE(answer["fits"]) << "warnings keep nothing from running";
}

/// The dead end: read in another unit, the drawing lies neither in the field nor between its marks.
TEST_F(Placing, AnotherUnitTakesMarksAndStartWithIt) {
  EXPECT_FALSE(plan(text_)["fits"]) << "220 mm are more than the field";
  const std::string only_unit = edited(text_, {{{"dieline", "unit"}, "px"}});
  EXPECT_FALSE(plan(only_unit)["fits"]) << "the marks and the start are those of the larger drawing";
  const std::string text = placed(text_, "px");
  const json answer = check(text);
  EXPECT_TRUE(answer["fits"]) << answer["issues"];
  EXPECT_EQ(answer["drawing"]["unsaid_unit"]["name"], "px");
  EXPECT_TRUE(plan(text)["fits"]) << plan(text)["issues"];
  EXPECT_THAT(answer["title"].get<std::string>(), HasSubstr("58.2 x 39.7 mm"));
  EXPECT_EQ(placed(text), text) << "there is no more to be done";
  // In the one step back all is as it was.
  const std::string back = placed(text, "mm");
  EXPECT_EQ(check(back)["sheet"], check(text_)["sheet"]);
  EXPECT_EQ(check(back)["title"], check(text_)["title"]);
  // What somebody wrote stays.
  for (const char* words :
       {"# Layers", "# Energy per area", "# The file does not say", "# 1.6 times what just"})
    if (text_.find(words) != std::string::npos) EXPECT_THAT(text, HasSubstr(words));
}

TEST_F(Placing, TheSheetOfAnAnswerIsThatOfTheScenario) {
  const json sheet = check(text_)["sheet"];
  ASSERT_EQ(sheet["marks"].size(), 5U);
  EXPECT_EQ(sheet["marks"][0]["diameter_mm"], kMarkDiameter_mm);
  EXPECT_FALSE(sheet["moves"]);
  EXPECT_TRUE(sheet["start_x_mm"].is_number());
  const fs::path moving = base::fixture("scenarios/native/label-on-belt.yaml");
  const json belt = json::parse(checkJson({base::contentOf(moving), moving}, kRequest))["sheet"];
  EXPECT_TRUE(belt["moves"]);
  EXPECT_TRUE(belt["start_x_mm"].is_null());
}

TEST_F(Placing, OnABeltTheStartIsLeftToThePlanner) {
  const fs::path moving = base::fixture("scenarios/native/label-on-belt.yaml");
  const std::string text = base::contentOf(moving);
  const std::string changed = json::parse(placeJson({text, moving}, std::nullopt, kRequest))["text"];
  EXPECT_TRUE(json::parse(planJson({changed, moving}, std::nullopt, kRequest))["fits"]);
  EXPECT_THAT(changed, Not(HasSubstr("start_x_mm")));
}

TEST_F(Placing, WhatIsNoUnitOrHasNoDrawingIsRefused) {
  EXPECT_THROW((void)placed(text_, "ell"), base::InputError);
  EXPECT_THROW((void)placed("name: a\n"), base::InputError);
}

TEST(PlaceOnSheet, MarksLieAroundTheDrawingAndItsMiddleInTheMiddleOfTheField) {
  const Eigen::AlignedBox2d field(Vector2d(-60, -50), Vector2d(60, 50));
  const Eigen::AlignedBox2d box(Vector2d(100, 200), Vector2d(160, 240));
  const SheetPlace place = placeOnSheet(box, field);
  EXPECT_DOUBLE_EQ(place.shift_y_mm, -220.0);
  EXPECT_DOUBLE_EQ(place.start_x_mm, -130.0);
  EXPECT_DOUBLE_EQ(place.pitch_mm, 80.0);
  ASSERT_EQ(place.marks_mm.size(), 5U);
  for (const Vector2d& mark : place.marks_mm) {
    EXPECT_GE(std::abs(mark.y()), 20.0 + 0.5 * kMarkDiameter_mm);
    EXPECT_TRUE(field.contains(mark + Vector2d(place.start_x_mm, 0.0))) << mark.transpose();
  }
}

}  // namespace
}  // namespace kerfbench::desk

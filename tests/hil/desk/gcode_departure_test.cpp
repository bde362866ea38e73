// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/gcode_departure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "hil/desk/first_scenario.h"
#include "hil/desk/job_plan.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

using nlohmann::json;
using planner::Segment;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kWithin_mm = 0.05;

std::vector<Segment> path(const std::string& gcode) { return planner::readGcode(gcode); }

/// A square of 20 mm and a circle of radius 5 in it.
const char* const kDrawn =
    "G00 X0 Y0 Z0\nG01 X20 Y0 Z1 (E0 cut)\nG01 X20 Y20 Z1 (E1 cut)\nG01 X0 Y20 Z1 (E2 cut)\nG01 X0 Y0 Z1 (E3 "
    "cut)\n"
    "G00 X15 Y10 Z0\nG03 X15 Y10 I-5 J0 Z1 (E4 cut)\n";

GcodeComparison compared(const std::string& gcode) {
  return comparedWithPlan(path(gcode), path(kDrawn), kWithin_mm);
}

TEST(GcodeDeparture, TheSameCutsInAnotherOrderAndSenseAreAsDrawn) {
  const auto found = compared(
      "G00 X15 Y10 Z0\nG02 X15 Y10 I-5 J0 Z1\nG00 X0 Y20 Z0\nG01 X20 Y20 Z1\nG01 X20 Y7 Z1\nG01 X20 Y0 Z1\n"
      "G01 X0 Y0 Z1\nG01 X0 Y20 Z1\n");
  EXPECT_THAT(found.departures, IsEmpty());
  EXPECT_THAT(found.uncut, IsEmpty());
}

TEST(GcodeDeparture, ALineThatLeavesTheDrawingIsNamedWithItsFarthestPlace) {
  std::string gcode = kDrawn;
  gcode.replace(gcode.find("G01 X20 Y20"), 11, "G01 X20 Y21");  // Lines 3 and 4 lead to another corner.
  const auto found = compared(gcode);
  ASSERT_EQ(found.departures.size(), 2U);
  EXPECT_EQ(found.departures[0].line, 3);
  EXPECT_NEAR(found.departures[0].off_mm, 1.0, 1e-9);
  EXPECT_LT((found.departures[0].p_S_mm - Eigen::Vector2d(20, 21)).norm(), 1e-9);
  EXPECT_EQ(found.departures[1].line, 4);
  ASSERT_EQ(found.uncut.size(), 1U) << "of the upper side all but its end at the other corner";
  EXPECT_EQ(found.uncut[0].entity, 2);
  EXPECT_NEAR(found.uncut[0].length_mm, 19.0, 0.5);
}

TEST(GcodeDeparture, TheDepartureOfAnArcIsThatOfItsRadius) {
  std::string gcode = kDrawn;
  gcode.replace(gcode.find("G00 X15"), std::string::npos, "G00 X15.2 Y10 Z0\nG03 X15.2 Y10 I-5.2 J0 Z1\n");
  const auto found = compared(gcode);
  ASSERT_EQ(found.departures.size(), 1U);
  EXPECT_NEAR(found.departures[0].off_mm, 0.2, 1e-6);
  EXPECT_EQ(found.departures[0].line, 7);
}

TEST(GcodeDeparture, JumpsAndDarkWaysMayLeadAnywhereAndTheFarIsNotMeasured) {
  const auto jump = compared(std::string(kDrawn) + "G00 X200 Y200 Z0\nG01 X210 Y200 Z0\n");
  EXPECT_THAT(jump.departures, IsEmpty());
  const auto far = compared(std::string(kDrawn) + "G00 X200 Y200 Z0\nG01 X210 Y200 Z1\n");
  ASSERT_EQ(far.departures.size(), 1U);
  EXPECT_EQ(far.departures[0].off_mm, kFarthestLooked_mm);
}

TEST(GcodeDeparture, WithinTheLimitNothingIsTold) {
  std::string gcode = kDrawn;
  gcode.replace(gcode.find("X20 Y20"), 7, "X20.04 Y20.02");
  EXPECT_THAT(compared(gcode).departures, IsEmpty());
  EXPECT_THAT(compared(gcode).uncut, IsEmpty());
}

/// Against brute force, over random polygons.
TEST(GcodeDeparture, TheGridLosesNothing) {
  unsigned state = 7;
  const auto number = [&] { return (state = state * 1664525U + 1013904223U) / 4294967296.0; };
  const auto random = [&](double from, double to) { return from + (to - from) * number(); };
  for (int round = 0; round < 20; ++round) {
    std::string drawn = "G00 X0 Y0 Z0\n", cut = drawn;
    std::vector<Eigen::Vector2d> corners{{0, 0}};
    for (int i = 0; i < 12; ++i) {
      corners.emplace_back(random(-30, 30), random(-30, 30));
      drawn += fmt::format("G01 X{} Y{} Z1\n", corners.back().x(), corners.back().y());
    }
    const Eigen::Vector2d to(random(-30, 30), random(-30, 30));
    cut += fmt::format("G01 X{} Y{} Z1\n", to.x(), to.y());
    double farthest_mm = 0.0;
    const int parts = std::max(1, static_cast<int>(std::ceil(to.norm() / kLookEvery_mm)));
    for (int i = 0; i <= parts; ++i) {
      const Eigen::Vector2d p = to * i / parts;
      double nearest_mm = 1e9;
      for (std::size_t k = 1; k < corners.size(); ++k) {
        const Eigen::Vector2d a = corners[k - 1], ab = corners[k] - a;
        const double u = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
        nearest_mm = std::min(nearest_mm, (p - a - u * ab).norm());
      }
      farthest_mm = std::max(farthest_mm, std::min(nearest_mm, kFarthestLooked_mm));
    }
    const auto found = comparedWithPlan(path(cut), path(drawn), kWithin_mm);
    ASSERT_EQ(found.departures.size(), farthest_mm > kWithin_mm ? 1U : 0U) << round;
    if (!found.departures.empty()) EXPECT_NEAR(found.departures[0].off_mm, farthest_mm, 1e-5) << round;
  }
}

TEST(PlanOfEditedGcode, TellsWhichLineLeavesTheDrawingAtRest) {
  const base::TempFolder temp;
  const auto out = temp.path() / "mine.yaml";
  const std::string text = firstScenario(
      {base::fixture("dielines/label-60x40.dxf"), base::fixture("machines/two-mirror.yaml"), out}, kRequest);
  const json planned = json::parse(planJson({text, out}, std::nullopt, kRequest));
  ASSERT_TRUE(planned["fits"]) << planned["issues"];
  EXPECT_THAT(planned["issues"], IsEmpty());
  const std::string gcode = planned["gcode"];
  EXPECT_THAT(json::parse(planJson({text, out}, gcode, kRequest))["issues"], IsEmpty())
      << "as it was planned";
  // What is cut last is left out, and a line is cut where nothing is drawn.
  const std::string edited = gcode.substr(0, gcode.rfind("G00")) + "G00 X-25 Y0 Z0\nG01 X-35 Y0 Z1\n";
  const auto last_line = std::ranges::count(edited, '\n');
  const json answer = json::parse(planJson({text, out}, edited, kRequest));
  EXPECT_TRUE(answer["fits"]) << answer["issues"];
  ASSERT_GE(answer["issues"].size(), 2U);
  EXPECT_EQ(answer["issues"][0]["line"], last_line);
  EXPECT_EQ(answer["issues"][0]["severity"], "warning");
  EXPECT_THAT(answer["issues"][0]["message"].get<std::string>(),
              HasSubstr("its cut leaves the drawing by 2 mm or more"));
  EXPECT_EQ(answer["issues"][0]["where_mm"].size(), 2U);
  const json& last = answer["issues"].back();
  EXPECT_THAT(last["message"].get<std::string>(), HasSubstr("cut by no line of the G-code"));
  EXPECT_EQ(last["entities"].size(), 1U);
}

}  // namespace
}  // namespace kerfbench::desk

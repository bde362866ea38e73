// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/hand_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/desk/job_plan.h"
#include "hil/desk/scenario_check.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/desk/desk_request_here.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A carton at rest: outlines, creases and a window.
class HandOrder : public testing::Test {
 protected:
  const fs::path file_ = base::fixture("scenarios/native/carton-on-belt.yaml");
  const std::string text_ = base::contentOf(file_) + "belt: {speed_mm_s: 0, start_x_mm: 70}\n";
  json order(const std::vector<int>& ids) { return json::parse(orderJson({text_, file_}, ids, kRequest)); }
};

TEST_F(HandOrder, AnyOrderIsCutAsItIsGiven) {
  const json planned = order({});
  std::vector<int> ids = planned["order"];
  ASSERT_GT(ids.size(), 20U);
  EXPECT_EQ(planned["text"], text_);
  std::mt19937 random(7);  // NOLINT: the same order in each run.
  for (int i = 0; i < 3; ++i) {
    std::shuffle(ids.begin(), ids.end(), random);
    const json answer = order(ids);
    EXPECT_EQ(answer["order"].get<std::vector<int>>(), ids) << answer["issues"];
    const json plan = json::parse(planJson({answer["text"], file_}, std::nullopt, kRequest));
    EXPECT_TRUE(plan["fits"]) << plan["issues"];
    EXPECT_EQ(plan["order"].get<std::vector<int>>(), ids);
    EXPECT_TRUE(json::parse(checkJson({answer["text"], file_}, kRequest))["fits"]);
    // Taken out again, the text is as it was.
    EXPECT_EQ(json::parse(orderJson({answer["text"], file_}, {}, kRequest))["text"], text_);
  }
}

TEST_F(HandOrder, TheOrderThatThePlannerFindsCostsNoMoreByHand) {
  const json planned = json::parse(planJson({text_, file_}, std::nullopt, kRequest));
  const json given = order(planned["order"].get<std::vector<int>>());
  const json plan = json::parse(planJson({given["text"], file_}, std::nullopt, kRequest));
  EXPECT_TRUE(given["issues"].empty()) << given["issues"];
  EXPECT_LE(plan["facts"]["jump_length_mm"].get<double>(),
            planned["facts"]["jump_length_mm"].get<double>() + 1e-3);
  EXPECT_NEAR(plan["facts"]["cut_length_mm"], planned["facts"]["cut_length_mm"], 0.01);
}

TEST_F(HandOrder, WhatIsNoOrderOfTheDrawingIsRefused) {
  std::vector<int> ids = order({})["order"];
  const int left_out = ids.back();
  ids.pop_back();
  ids.push_back(ids.front());
  ids.push_back(4711);
  const json answer = order(ids);
  const std::string issues = answer["issues"].dump();
  EXPECT_THAT(issues, testing::HasSubstr("E" + std::to_string(left_out) + ": not named"));
  EXPECT_THAT(issues, testing::HasSubstr("named more than once"));
  EXPECT_THAT(issues, testing::HasSubstr("E4711: not in the drawing"));
  EXPECT_EQ(answer["issues"][0]["key"], "planner.order");
  EXPECT_EQ(answer["issues"][0]["line"], base::lineOf(answer["text"], "order:"));
  const json plan = json::parse(planJson({answer["text"], file_}, std::nullopt, kRequest));
  EXPECT_FALSE(plan["fits"]);
}

TEST_F(HandOrder, CreasesAfterTheOutlineAroundThemAreDoubtful) {
  std::vector<int> ids = order({})["order"];
  EXPECT_TRUE(order(ids)["issues"].empty());
  std::ranges::reverse(ids);
  const json answer = order(ids);
  ASSERT_FALSE(answer["issues"].empty());
  EXPECT_EQ(answer["issues"][0]["severity"], "warning");
  EXPECT_THAT(answer["issues"][0]["message"].get<std::string>(), testing::HasSubstr("may have moved"));
}

/// Where entities are parts of a longer way: a perforation's dashes, the beam's path beside the lines.
TEST(HandOrderOfParts, PerforationsAndCompensatedCutsComeInTheGivenOrder) {
  std::mt19937 random(8);  // NOLINT: the same order in each run.
  for (const auto& [name, more] :
       {std::pair{"native/coupon-perforated.yaml",
                  "machine: ../../machines/f-theta-300.yaml\nbelt: {speed_mm_s: 0, start_x_mm: 88}\n"},
        std::pair{
            "native/label-on-belt.yaml",
            "print: {units: 1}\nbelt: {speed_mm_s: 0, start_x_mm: 30}\nplanner: {kerf_radius_mm: 0.1}\n"}}) {
    const fs::path file = base::fixture(std::string("scenarios/") + name);
    const std::string text = fmt::format("extends: '{}'\nname: parts\n{}", file.string(), more);
    const fs::path mine = file.parent_path() / "parts.yaml";
    std::vector<int> ids = json::parse(orderJson({text, mine}, {}, kRequest))["order"];
    ASSERT_GT(ids.size(), 3U) << name;
    std::shuffle(ids.begin(), ids.end(), random);
    const json ordered = json::parse(orderJson({text, mine}, ids, kRequest));
    EXPECT_EQ(ordered["order"].get<std::vector<int>>(), ids) << ordered["issues"];
    const json plan = json::parse(planJson({ordered["text"], mine}, std::nullopt, kRequest));
    EXPECT_TRUE(plan["fits"]) << plan["issues"];
    const json planned = json::parse(planJson({text, mine}, std::nullopt, kRequest));
    // The same is cut, whatever the order.
    EXPECT_NEAR(plan["facts"]["cut_length_mm"], planned["facts"]["cut_length_mm"], 0.02) << name;
  }
}

TEST(OrderWords, NeighboursBecomeRanges) {
  EXPECT_EQ(orderWords({3, 0, 5, 6, 7, 9, 10}), (std::vector<std::string>{"3", "0", "5-7", "9", "10"}));
  EXPECT_TRUE(orderWords({}).empty());
}

}  // namespace
}  // namespace kerfbench::desk

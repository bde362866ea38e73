// SPDX-License-Identifier: Apache-2.0
// A job is prepared over the wire: from a drawing to a plan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

using Json = nlohmann::json;

class DeskRoutesTest : public testing::Test {
 protected:
  [[nodiscard]] Reply post(const std::string& path, const Json& body) const {
    return client_.ask({"POST", path, body.dump(), {}});
  }
  [[nodiscard]] Json good(const std::string& path, const Json& body) const {
    const Reply reply = post(path, body);
    EXPECT_EQ(reply.status, 200) << path << " " << reply.body.substr(0, 500);
    return reply.status == 200 ? Json::parse(reply.body) : Json::object();
  }

  InstalledBench bench_;
  Served served_{bench_, std::filesystem::path(KERFBENCH_BINARY_DIR) / "bin"};
  Client client_{served_.client()};
};

TEST_F(DeskRoutesTest, ADrawingBecomesAJobThatFits) {
  const std::string drawing = base::contentOf(base::fixture("dielines/label-60x40.dxf"));
  ASSERT_EQ(client_.put("/api/files?path=mine/label.dxf", drawing).status, 200);
  const Json made = good("/api/new", {{"drawing", "mine/label.dxf"}, {"name", "My label"}});
  ASSERT_EQ(made["path"], "mine/My-label.yaml");
  EXPECT_EQ(base::contentOf(bench_.path("work/mine/My-label.yaml")), made["text"]);
  Json job{{"scenario_text", made["text"]}, {"path", made["path"]}};
  const Json checked = good("/api/check", job);
  EXPECT_EQ(checked["fits"], true) << checked["issues"];
  EXPECT_EQ(checked["drawing"]["file"], "mine/label.dxf");
  EXPECT_EQ(checked["machine"]["file"], "shipped/machines/two-mirror.yaml");

  const Json edited = good("/api/edit", {{"text", made["text"]},
                                         {"set", {{{"path", "planner.mark_speed_mm_s"}, {"value", 120}}}}});
  job["scenario_text"] = edited["text"];
  const Json plan = good("/api/plan", job);
  EXPECT_EQ(plan["fits"], true) << plan["issues"];
  const std::size_t periods = plan["preview"]["x_mm"].size();
  EXPECT_GT(periods, 500U);
  EXPECT_EQ(plan["preview"]["gate"].size(), periods);

  std::vector<int> order = plan["order"];
  std::ranges::reverse(order);
  job["order"] = order;
  const Json ordered = good("/api/order", job);
  EXPECT_EQ(ordered["order"], Json(order));
  EXPECT_THAT(ordered["issues"].dump(), testing::HasSubstr("may have moved"));

  job["gcode"] = "G00 X-40 Y0 Z0\nG01 X-20 Q0 Z1\n";
  const Json faulty = good("/api/plan", job);
  EXPECT_EQ(faulty["fits"], false);
  EXPECT_EQ(faulty["issues"][0]["line"], 2);
}

TEST_F(DeskRoutesTest, ADrawingIsLaidAnewInAnotherUnit) {
  bench_.write(
      "work/a.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='240' height='170'><rect x='9' y='9' width='220' "
      "height='150' fill='none' stroke='black'/></svg>");
  const Json made = good("/api/new", {{"drawing", "a.svg"}});
  const Json placed =
      good("/api/place", {{"scenario_text", made["text"]}, {"path", made["path"]}, {"unit", "px"}});
  const Json plan = good("/api/plan", {{"scenario_text", placed["text"]}, {"path", made["path"]}});
  EXPECT_EQ(plan["fits"], true) << plan["issues"];
  EXPECT_EQ(post("/api/place", {{"scenario_text", made["text"]}, {"path", made["path"]}, {"unit", 3}}).status,
            400);
  EXPECT_EQ(post("/api/place", {{"scenario_text", "name: a"}, {"path", "a.yaml"}}).status, 400);
}

TEST_F(DeskRoutesTest, ADrawingOfFillsAloneIsRefusedAndNotWritten) {
  const std::string fills =
      "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='40mm' viewBox='0 0 60 40'>\n"
      "<rect width='20' height='20' fill='red'/></svg>";
  const Reply refused = client_.put("/api/files?path=fills.svg&as=new", fills);
  EXPECT_EQ(refused.status, 400);
  const std::string words = Json::parse(refused.body)["error"];
  EXPECT_THAT(words, testing::StartsWith("fills.svg: it holds no line that could be cut"));
  EXPECT_THAT(words, testing::HasSubstr("fills.svg:2: rect without a stroke: 1 left out"));
  EXPECT_THAT(words, testing::Not(testing::HasSubstr("/tmp")));
  EXPECT_FALSE(std::filesystem::exists(bench_.path("work/fills.svg")));
  EXPECT_EQ(client_.put("/api/files?path=none.dxf&as=new", "no drawing").status, 400);
  EXPECT_FALSE(std::filesystem::exists(bench_.path("work/none.dxf")));
}

TEST_F(DeskRoutesTest, AFileIsNeitherWrittenTwiceNorReplacedInSilence) {
  const std::string drawing = base::contentOf(base::fixture("dielines/label-60x40.dxf"));
  const std::string other = base::contentOf(base::fixture("dielines/button.dxf"));
  const auto bring = [&](const std::string& query, const std::string& bytes) {
    const Reply reply = client_.put("/api/files?path=mine/a.dxf&as=" + query, bytes);
    return std::pair(reply.status, reply.status == 200 ? Json::parse(reply.body)["was_there"] : Json());
  };
  EXPECT_EQ(bring("new", drawing), std::pair(200, Json(false)));
  const auto file = bench_.path("work/mine/a.dxf");
  const auto written = std::filesystem::last_write_time(file);
  EXPECT_EQ(bring("new", drawing), std::pair(200, Json(true)));
  EXPECT_EQ(bring("replace", drawing), std::pair(200, Json(true)));
  EXPECT_EQ(std::filesystem::last_write_time(file), written) << "the same bytes are not written again";
  EXPECT_EQ(bring("new", other), std::pair(409, Json()));
  EXPECT_EQ(base::contentOf(file), drawing);
  EXPECT_EQ(bring("replace", other), std::pair(200, Json(false)));
  EXPECT_EQ(base::contentOf(file), other);
  EXPECT_EQ(bring("replace", "no drawing"), std::pair(400, Json()));
  EXPECT_EQ(base::contentOf(file), other);
  EXPECT_EQ(bring("somehow", drawing).first, 400);
  EXPECT_EQ(client_.put("/api/files?path=results/a.dxf&as=new", drawing).status, 400);
  EXPECT_EQ(client_.put("/api/files?path=shipped/a.dxf&as=replace", drawing).status, 403);
  EXPECT_EQ(client_.put("/api/files?path=a.exe&as=new", drawing).status, 415);
}

TEST_F(DeskRoutesTest, AShippedScenarioIsCopiedWithItsFiles) {
  const char* from = "shipped/scenarios/native/label-on-belt.yaml";
  const Json first = good("/api/new", {{"from", from}, {"name", "own"}});
  const Json second = good("/api/new", {{"from", from}, {"name", "own"}});
  EXPECT_EQ(first["path"], "own.yaml");
  EXPECT_EQ(second["path"], "own-2.yaml");
  const Json checked = good("/api/check", {{"scenario_text", second["text"]}, {"path", second["path"]}});
  EXPECT_EQ(checked["fits"], true) << checked["issues"];
  EXPECT_EQ(checked["name"], "own-2");
}

TEST_F(DeskRoutesTest, WhatIsNoRequestIsRefusedWithASentence) {
  bench_.write("work/s.yaml", "name: s\n");
  for (const auto& [path, body, status] : std::vector<std::tuple<std::string, Json, int>>{
           {"/api/new", {{"drawing", "../s.yaml"}}, 0},
           {"/api/new", {{"drawing", "none.dxf"}}, 404},
           {"/api/new", {{"drawing", "s.yaml"}}, 400},
           {"/api/new", Json::object(), 400},
           {"/api/order", {{"scenario_text", ""}, {"path", "s.yaml"}, {"order", "1"}}, 400},
           {"/api/order", {{"scenario_text", ""}, {"path", "s.yaml"}, {"order", {"1"}}}, 400},
           {"/api/plan", {{"scenario_text", 5}}, 400},
           {"/api/edit", {{"text", "a: 1"}, {"set", 1}}, 400}}) {
    const Reply reply = post(path, body);
    EXPECT_GE(reply.status, 400) << path << body;
    if (status != 0) EXPECT_EQ(reply.status, status) << path << body << reply.body;
    EXPECT_FALSE(Json::parse(reply.body)["error"].get<std::string>().empty());
  }
  EXPECT_EQ(post("/api/edit", {{"text", "a: [1"}, {"set", {{{"path", "a"}, {"value", 1}}}}}).status, 400);
}

TEST_F(DeskRoutesTest, TheReferenceIsAnswered) {
  const Reply reply = client_.get("/api/reference?page=machine");
  ASSERT_EQ(reply.status, 200);
  EXPECT_GT(Json::parse(reply.body)["sections"].size(), 10U);
  EXPECT_EQ(client_.get("/api/reference?page=..%2Fcli").status, 400);
}

}  // namespace
}  // namespace kerfbench::serve

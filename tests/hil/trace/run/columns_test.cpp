// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/trace/run/burnt_path.h"
#include "hil/trace/run/chord.h"
#include "hil/trace/run/overview.h"
#include "hil/trace/run/program_follower.h"
#include "hil/trace/run/wired_signals.h"
#include "twin/base/random.h"

namespace kerfbench::trace {
namespace {

using nlohmann::json;
using testing::ElementsAre;

SignalMap wiring() {
  SignalMap map;
  map.assign(Signal::kGalvoXPul, {0, 0});
  map.assign(Signal::kGalvoXDir, {0, 1});
  map.assign(Signal::kLaserGate, {1, 0});
  map.assign(Signal::kEncoderA, {2, 3});
  // One wire enables two drives.
  map.assign(Signal::kGalvoXEnable, {0, 4});
  map.assign(Signal::kGalvoYEnable, {0, 4});
  return map;
}

std::vector<std::pair<Tick, int>> ticksAndIds(const std::vector<PinEdge>& edges) {
  std::vector<std::pair<Tick, int>> all;
  for (const PinEdge& edge : edges) all.emplace_back(edge.tick, edge.level ? edge.id : -1 - edge.id);
  return all;
}

TEST(WiredSignals, NumberTheWiresOfTheirOwn) {
  const WiredSignals wired(wiring());
  EXPECT_THAT(wired.signals(), ElementsAre(Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kLaserGate,
                                           Signal::kGalvoXEnable, Signal::kEncoderA));
  EXPECT_EQ(wired.idOf(Signal::kEncoderA), 4);
  EXPECT_EQ(wired.idOf(Signal::kGalvoYPul), std::nullopt);
}

TEST(WiredSignals, GiveTheEdgesOfControllerAndSensorsByTick) {
  WiredSignals wired(wiring());
  // A write that changes two pins at once; one that changes a pin which is not wired.
  const std::vector<PinEvent> events{{10, 0, 3, 3, 0}, {20, 0, 1, 2, 0}, {30, 0, 0x80, 0x82, 0}};
  const std::vector<SensorEdge> sensors{
      {5, Signal::kEncoderA, true}, {10, Signal::kEncoderA, false}, {25, Signal::kPrintMark, true}};
  const auto edges = ticksAndIds(wired.edgesOf(events, sensors));
  EXPECT_THAT(edges, ElementsAre(std::pair(5U, 4), std::pair(10U, 0), std::pair(10U, 1), std::pair(10U, -5),
                                 std::pair(20U, -1)));
  // A level that is there already is no edge.
  EXPECT_TRUE(wired.edgesOf(std::vector<PinEvent>{{40, 0, 0, 2, 0}}, {}).empty());
}

TEST(PinBatch, CountsFromItsFirstEdge) {
  PinBatch batch;
  for (const PinEdge& edge : {PinEdge{100, 0, true}, {100, 1, true}, {130, 0, false}}) batch.add(edge);
  EXPECT_EQ(batch.take(), R"({"tick0":100,"dt":[0,0,30],"id":[0,1,0],"level":[1,1,0]})");
  EXPECT_TRUE(batch.empty());
}

/// Paths of messages of /burnt, pieced together.
struct Burnt {
  std::vector<std::vector<Eigen::Vector2d>> paths;
  std::size_t points{};
  void take(const std::optional<BurntPath::Message>& message) {
    if (!message) return;
    const json read = json::parse(message->json);
    for (std::size_t i = 0; i < read["x_mm"].size(); ++i) {
      if (read["start"][i] == 1) paths.emplace_back();
      paths.back().emplace_back(read["x_mm"][i].get<double>(), read["y_mm"][i].get<double>());
      ++points;
    }
  }
  [[nodiscard]] double distanceOf(const Eigen::Vector2d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& path : paths)
      for (std::size_t i = 1; i < path.size(); ++i)
        least = std::min(least, distanceToChord_mm(p, path[i - 1], path[i]));
    return least;
  }
};

TEST(BurntPath, StaysWithinItsToleranceWithFarFewerPoints) {
  BurntPath burnt;
  Burnt read;
  std::vector<Eigen::Vector2d> all;
  for (int i = 0; i <= 8000; ++i) {
    const double t = 0.0005 * i;
    // A circle, then a straight line, both at 100 mm/s.
    const double a = t * 10.0;
    const Eigen::Vector2d p =
        t < 2.0 ? Eigen::Vector2d(10 * std::cos(a), 10 * std::sin(a))
                : Eigen::Vector2d(10 * std::cos(20.0) + 100 * (t - 2.0), 10 * std::sin(20.0));
    read.take(burnt.add(t, p, i > 0));
    all.push_back(p);
  }
  read.take(burnt.end());
  for (const Eigen::Vector2d& p : all) ASSERT_LE(read.distanceOf(p), BurntPath::kTolerance_mm + 1e-4);
  EXPECT_LT(read.points, all.size() / 10);
  // Each second begins anew where the one before ended.
  ASSERT_EQ(read.paths.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(read.paths[i].front(), read.paths[i - 1].back());
}

TEST(BurntPath, LeavesOutWhatIsDarkAndWhatMissesTheBoard) {
  BurntPath burnt;
  Burnt read;
  const double nan = std::nan("");
  for (const auto& [t, x, lit] : {std::tuple{0.0, 0.0, false},
                                  {0.1, 1.0, true},
                                  {0.2, 2.0, false},
                                  {0.3, 3.0, true},
                                  {0.4, nan, true},
                                  {0.5, 5.0, true},
                                  {0.6, 6.0, true}})
    read.take(burnt.add(t, {x, 0.0}, lit));
  read.take(burnt.end());
  ASSERT_EQ(read.paths.size(), 3U);
  EXPECT_THAT(read.paths[0], ElementsAre(Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0)));
  EXPECT_THAT(read.paths[1], ElementsAre(Eigen::Vector2d(2, 0), Eigen::Vector2d(3, 0)));
  EXPECT_THAT(read.paths[2], ElementsAre(Eigen::Vector2d(5, 0), Eigen::Vector2d(6, 0)));
}

// Every level has the edges and extremes of the intervals as a count by hand has them.
TEST(Overview, EachLevelHasTheSumsOfItsIntervals) {
  std::map<Topic, std::vector<json>> messages;
  Overview overview({"belt_mm", "spot_x_mm"}, 2, [&](Topic topic, double from_s, const std::string& text) {
    messages[topic].push_back(json::parse(text));
    EXPECT_DOUBLE_EQ(messages[topic].back()["from_s"].get<double>(), from_s);
  });
  const CounterRandom random(5, 0);
  std::vector<double> belt;
  std::vector<int> edges;
  constexpr int kQuanta = 25'300;  // 12.65 s
  for (int i = 1; i <= kQuanta; ++i) {
    const auto count = static_cast<int>(4.0 * random.uniform(static_cast<std::uint64_t>(i)));
    for (int k = 0; k < count; ++k) overview.addEdge(1, k % 2 == 0);
    belt.push_back(std::round(1e4 * random.normal(static_cast<std::uint64_t>(i))) / 1e4);
    edges.push_back(count);
    overview.addRow(0.0005 * i, {belt.back(), i % 2 == 0 ? 1.0 : std::nan("")}, 0.00025);
  }
  overview.end();
  EXPECT_EQ(messages[Topic::kOverview100ms].size(), 2U);
  EXPECT_EQ(messages[Topic::kOverview100s].size(), 1U);
  for (std::size_t level = 0; level < kOverviewSteps_s.size(); ++level) {
    const auto topic = static_cast<Topic>(static_cast<std::size_t>(Topic::kOverview100ms) + level);
    const auto quanta = static_cast<std::size_t>(std::lround(kOverviewSteps_s.at(level) / 0.0005));
    std::size_t first = 0;
    for (const json& message : messages[topic]) {
      for (std::size_t row = 0; row < message["rows"].get<std::size_t>(); ++row, first += quanta) {
        const std::size_t end = std::min(first + quanta, belt.size());
        const auto begin = belt.begin() + static_cast<std::ptrdiff_t>(first);
        const auto last = belt.begin() + static_cast<std::ptrdiff_t>(end);
        EXPECT_EQ(message["columns"]["belt_mm"]["min"][row], *std::min_element(begin, last));
        EXPECT_EQ(message["columns"]["belt_mm"]["max"][row], *std::max_element(begin, last));
        EXPECT_EQ(message["columns"]["spot_x_mm"]["min"][row], 1.0);
        int sum = 0;
        for (std::size_t i = first; i < end; ++i) sum += edges[i];
        EXPECT_EQ(message["pins"][1]["edges"][row], sum);
        EXPECT_EQ(message["pins"][0]["edges"][row], 0);
        EXPECT_NEAR(message["lit_s"][row].get<double>(), 0.00025 * static_cast<double>(end - first), 1e-9);
      }
    }
    EXPECT_GE(first, belt.size());
  }
}

constexpr const char* kSquare =
    "G00 X0 Y0 Z0\n"
    "G01 X10 Y0 Z1\n"
    "G01 X10 Y10 Z1\n"
    "G00 X20 Y10 Z0\n"
    "G01 X30 Y10 Z1\n";

std::vector<ProgramFollower::Place> followed(
    ProgramFollower& follower, const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& ways,
    double offset_mm) {
  std::vector<ProgramFollower::Place> places;
  for (const auto& [from, to] : ways) {
    constexpr int kSteps = 40;
    for (int i = 0; i <= kSteps; ++i) {
      const Eigen::Vector2d p = from + (to - from) * i / kSteps + Eigen::Vector2d(offset_mm, 0.5 * offset_mm);
      const ProgramFollower::Place place = follower.follow(p);
      if (places.empty() || !(places.back() == place)) places.push_back(place);
    }
  }
  return places;
}

TEST(ProgramFollower, TellsTheLineOfEachPieceAndUnitInOrder) {
  ProgramFollower follower(kSquare, {2, 50.0, false});
  ASSERT_FALSE(follower.empty());
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> ways{{{-30, 5}, {-1, 0.0}}};
  for (const double x : {0.0, -50.0}) {
    ways.insert(ways.end(), {{{x + 0, 0}, {x + 10, 0}},
                             {{x + 10, 0}, {x + 10, 10}},
                             {{x + 10, 10}, {x + 20, 10}},
                             {{x + 20, 10}, {x + 30, 10}}});
  }
  const auto places = followed(follower, ways, 0.03);
  std::vector<std::pair<int, int>> lines;
  for (const auto& place : places)
    if (place.line > 0) lines.emplace_back(place.line, place.unit);
  EXPECT_THAT(lines, ElementsAre(std::pair(2, 0), std::pair(3, 0), std::pair(4, 0), std::pair(5, 0),
                                 std::pair(2, 1), std::pair(3, 1), std::pair(4, 1), std::pair(5, 1)));
  EXPECT_EQ(places.front(), ProgramFollower::Place{});
}

TEST(ProgramFollower, RunsOddUnitsBackwardsWhereTheJobDoes) {
  ProgramFollower follower(kSquare, {2, 50.0, true});
  const auto places = followed(follower,
                               {{{0, 0}, {10, 0}},
                                {{10, 0}, {10, 10}},
                                {{10, 10}, {20, 10}},
                                {{20, 10}, {30, 10}},
                                {{-20, 10}, {-30, 10}},
                                {{-30, 10}, {-40, 10}},
                                {{-40, 10}, {-40, 0}},
                                {{-40, 0}, {-50, 0}}},
                               0.0);
  std::vector<int> lines;
  for (const auto& place : places)
    if (place.line > 0) lines.push_back(place.line);
  EXPECT_THAT(lines, ElementsAre(2, 3, 4, 5, 5, 4, 3, 2));
  EXPECT_EQ(places.back().unit, 1);
}

TEST(ProgramFollower, KnowsNoLineOfAPlaceOrAProgramThatItDoesNotKnow) {
  ProgramFollower follower(kSquare, {1, 50.0, false});
  EXPECT_EQ(follower.follow(Eigen::Vector2d::Constant(std::nan(""))), ProgramFollower::Place{});
  EXPECT_EQ(follower.follow({500, 500}), ProgramFollower::Place{});
  EXPECT_TRUE(ProgramFollower("M104 S200\n", {}).empty());
  EXPECT_TRUE(ProgramFollower("", {}).empty());
}

}  // namespace
}  // namespace kerfbench::trace

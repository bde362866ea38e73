// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/air_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/order/cut_order.h"
#include "firmware_under_test/planner/program/order_table.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

Segment segment(const Vector2d& from, const Vector2d& to, int entity) {
  Segment s;
  s.start_mm = from;
  s.end_mm = to;
  s.entity = entity;
  s.z = 1.0;
  return s;
}

/// Open lines and triangles, of some ranks, in no order but that of their ranks.
std::vector<Stop> randomStops(std::mt19937& random, int count, int ranks) {
  const auto place = [&] {
    return Vector2d(double(random() % 10000) / 100.0, double(random() % 10000) / 100.0);
  };
  std::vector<Stop> stops;
  for (int i = 0; i < count; ++i) {
    Stop stop;
    const Vector2d a = place();
    const Vector2d b = place();
    stop.chain.segments.push_back(segment(a, b, i));
    if (random() % 3 == 0) {
      const Vector2d c = place();
      stop.chain.segments.push_back(segment(b, c, i));
      stop.chain.segments.push_back(segment(c, a, i));
    }
    stop.rank = static_cast<int>(random() % unsigned(ranks));
    stops.push_back(stop);
  }
  std::stable_sort(stops.begin(), stops.end(), [](const Stop& a, const Stop& b) { return a.rank < b.rank; });
  return stops;
}

/// Shortest path by trying every order, sense and start.
double exhaustive(const std::vector<Stop>& stops) {
  std::vector<std::size_t> order(stops.size());
  std::iota(order.begin(), order.end(), 0U);
  double best = std::numeric_limits<double>::infinity();
  do {
    bool sorted = true;
    for (std::size_t i = 1; i < order.size(); ++i)
      sorted = sorted && stops[order[i - 1]].rank <= stops[order[i]].rank;
    if (!sorted) continue;
    std::vector<std::pair<Vector2d, double>> ends;  // Out points and the shortest path to each.
    for (const std::size_t k : order) {
      const Chain& chain = stops[k].chain;
      std::vector<std::pair<Vector2d, Vector2d>> ways;
      if (chain.closed()) {
        for (const Segment& s : chain.segments) ways.emplace_back(s.start_mm, s.start_mm);
      } else {
        ways = {{chain.start(), chain.end()}, {chain.end(), chain.start()}};
      }
      std::vector<std::pair<Vector2d, double>> next;
      for (const auto& [in, out] : ways) {
        double least = ends.empty() ? 0.0 : std::numeric_limits<double>::infinity();
        for (const auto& [p, cost] : ends) least = std::min(least, cost + (in - p).norm());
        next.emplace_back(out, least);
      }
      ends = next;
    }
    for (const auto& end : ends) best = std::min(best, end.second);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(AirPath, OfSixPiecesIsTheShortestThereIs) {
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    const std::vector<Stop> stops = randomStops(random, 6, 1 + round % 3);
    EXPECT_NEAR(airPathMm(shortened(stops, {}, 0)), exhaustive(stops), 1e-6) << "round " << round;
  }
}

TEST(AirPath, NothingIsLostDoubledOrOutOfTheSequenceOfItsRanks) {
  std::mt19937 random(11);
  for (int round = 0; round < 10; ++round) {
    const std::vector<Stop> stops = randomStops(random, 60, 4);
    const std::vector<Stop> shorter = shortened(stops, {}, 0);
    ASSERT_EQ(shorter.size(), stops.size());
    EXPECT_LT(airPathMm(shorter), 0.5 * airPathMm(stops));
    std::set<int> entities;
    for (std::size_t i = 0; i < shorter.size(); ++i) {
      const Chain& now = shorter[i].chain;
      const Chain& then = std::find_if(stops.begin(), stops.end(), [&](const Stop& s) {
                            return s.chain.segments[0].entity == now.segments[0].entity;
                          })->chain;
      entities.insert(now.segments[0].entity);
      EXPECT_EQ(now.closed(), then.closed());
      for (std::size_t k = 1; k < now.segments.size(); ++k)
        EXPECT_EQ(now.segments[k].start_mm, now.segments[k - 1].end_mm);
      EXPECT_LE(shorter[i > 0 ? i - 1 : 0].rank, shorter[i].rank);
    }
    EXPECT_EQ(entities.size(), stops.size());
  }
}

TEST(AirPath, ARankThatTheOrderGivenBreaksMayStayBroken) {
  // Rank 1 comes first and is far from where rank 0 lies: the given order may stay.
  std::vector<Stop> stops(3);
  stops[0] = {Chain{dieline::Process::kCut, {segment({0, 0}, {1, 0}, 0)}, 0}, 1};
  stops[1] = {Chain{dieline::Process::kCut, {segment({50, 0}, {40, 0}, 1)}, 0}, 0};
  stops[2] = {Chain{dieline::Process::kCut, {segment({60, 0}, {70, 0}, 2)}, 0}, 1};
  EXPECT_NEAR(airPathMm(shortened(stops, {}, 0)), 39.0 + 10.0, 1e-9);
  // In the sequence of their ranks they keep it, although the other order would be shorter.
  std::swap(stops[0].rank, stops[1].rank);
  stops[1].chain.segments[0] = segment({100, 0}, {99, 0}, 1);
  EXPECT_EQ(shortened(stops, {}, 0)[0].chain.segments[0].entity, 0);
}

TEST(AirPath, OnlyOrdersThatFitAreTaken) {
  std::mt19937 random(3);
  const std::vector<Stop> stops = randomStops(random, 12, 1);
  int asked = 0;
  const auto fits = [&](const std::vector<Stop>& order) {
    ++asked;
    return order.front().chain.segments[0].entity == stops.front().chain.segments[0].entity;
  };
  const std::vector<Stop> shorter = shortened(stops, fits, 500);
  EXPECT_TRUE(fits(shorter));
  EXPECT_LT(airPathMm(shorter), airPathMm(stops));
  asked = 0;
  EXPECT_EQ(airPathMm(shortened(
                stops, [&](const auto&) { return ++asked, false; }, 20)),
            airPathMm(stops));
  EXPECT_EQ(asked, 20);
}

TEST(AirPath, AnOutlineWithCornersBeginsAtOne) {
  std::vector<Stop> stops(2);
  stops[0] = {Chain{dieline::Process::kCut, {segment({0, 0}, {1, 0}, 0)}, 0}, 0};
  // A rounded triangle whose nearest joint is tangent.
  Segment arc;
  arc.start_mm = {10, 0};
  arc.end_mm = {10, 2};
  arc.centre_mm = {10, 1};
  arc.sweep_rad = -3.14159265358979;
  arc.entity = 1;
  stops[1] = {
      Chain{dieline::Process::kCut, {segment({30, 1}, {10, 0}, 1), arc, segment({10, 2}, {30, 1}, 1)}, 0}, 0};
  const auto shorter = shortened(stops, {}, 0);
  const auto& outline = shorter[0].chain.closed() ? shorter[0] : shorter[1];
  EXPECT_EQ(outline.chain.start(), Vector2d(30, 1));
}

TEST(AirPath, OfTheFixturesIsShorterThanNearestAndDrawn) {
  struct Case {
    const char* file;
    double belt_mm_s, share_of_nearest, share_of_drawn;
  };
  for (const Case& c :
       {Case{"label-60x40.dxf", 60.0, 0.62, 0.57}, Case{"tuck-end-carton.dxf", 30.0, 0.25, 0.23},
        Case{"coupon-perforated.dxf", 40.0, 0.67, 0.78}}) {
    JobParameters job = test::mirrorJob();
    job.belt_speed_mm_s = c.belt_mm_s;
    const dieline::Dieline dieline = dieline::readDieline(
        std::string(KERFBENCH_SOURCE_DIR) + "/fixtures/dielines/" + c.file, dieline::defaultLayerProfile());
    const auto costs = orderCosts(dieline, test::twoMirror(), job);
    ASSERT_TRUE(costs[0].unit_time_s && costs[1].unit_time_s) << c.file;
    EXPECT_LT(costs[0].air_path_mm, c.share_of_nearest * costs[1].air_path_mm) << c.file;
    EXPECT_LT(costs[0].air_path_mm, c.share_of_drawn * costs[2].air_path_mm) << c.file;
    EXPECT_LT(*costs[0].unit_time_s, *costs[1].unit_time_s) << c.file;
    EXPECT_GE(costs[0].max_belt_speed_mm_s, 1.09 * c.belt_mm_s) << "room for a line that runs faster";
  }
}

TEST(Order, AsDrawnIsAsDrawn) {
  JobParameters job = test::mirrorJob();
  job.order = JobParameters::Order::kDrawn;
  const auto order = drawnOrder(test::carton(), job, {});
  ASSERT_EQ(order.size(), test::carton().entities.size());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i].chain.segments[0].entity, int(i));
}

TEST(Order, OfManyPiecesTakesLittleTime) {
  std::vector<dieline::Entity> entities;
  std::mt19937 random(5);
  const auto place = [&] { return double(random() % 16000) / 100.0 - 80.0; };
  for (int i = 0; i < 600; ++i) {
    const double x = place();
    const double y = place();
    entities.push_back(test::line(x, y, x + 1.0, y + 1.0));
  }
  const auto order = nearestOrder(test::dielineOf(entities), test::mirrorJob(), {}, {});
  const auto shorter = shortened(order, {}, 0);
  EXPECT_LT(airPathMm(shorter), 0.9 * airPathMm(order));
}

}  // namespace
}  // namespace kerfbench::planner

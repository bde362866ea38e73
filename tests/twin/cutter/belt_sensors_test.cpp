// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/sensors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kCountMm = 0.01;
constexpr Tick kQuantum = 8000;  // 0.5 ms
constexpr double kNoMark = 1e9;

PrintLayout print(int units) { return {units, 50.0, 0.0, 4.0, {}}; }

BeltSensors encoder() { return {kRate, kCountMm, print(1), kNoMark}; }

TEST(BeltSensors, ForwardALeadsB) {
  auto sensors = encoder();
  const auto edges = sensors.edges({0, 0.0, 100.0, 0.0}, kQuantum);  // 0.05 mm: counts 1 … 5.
  ASSERT_EQ(edges.size(), 5U);
  const std::vector<std::pair<Signal, bool>> expected{{Signal::kEncoderA, true},
                                                      {Signal::kEncoderB, true},
                                                      {Signal::kEncoderA, false},
                                                      {Signal::kEncoderB, false},
                                                      {Signal::kEncoderA, true}};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(std::pair(edges[i].signal, edges[i].level), expected[i]) << i;
  }
}

TEST(BeltSensors, EachCountComesWithinATickOfItsPlaceOnTheBelt) {
  for (const double acceleration : {0.0, 4000.0, -4000.0}) {
    auto sensors = encoder();
    const double speed = 300.0;
    const auto edges = sensors.edges({1000, 0.0, speed, acceleration}, 1000 + kQuantum);
    ASSERT_GE(edges.size(), 14U);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const double s = kCountMm * static_cast<double>(i + 1);
      const double at_s = 2.0 * s / (speed + std::sqrt(speed * speed + 2.0 * acceleration * s));
      const double late = static_cast<double>(edges[i].tick - 1000) - at_s * 16e6;
      EXPECT_GE(late, -1e-6);
      EXPECT_LE(late, 1.0 + 1e-6);
    }
  }
}

TEST(BeltSensors, ABeltThatTurnsBackCountsBack) {
  auto sensors = encoder();
  QuadratureCounter counter;
  for (const SensorEdge& e : sensors.edges({0, 0.0, 200.0, 0.0}, kQuantum)) counter.apply(e);
  EXPECT_EQ(counter.count(), 10);
  const auto back = sensors.edges({kQuantum, 0.1, -300.0, 0.0}, 2 * kQuantum);
  for (const SensorEdge& e : back) counter.apply(e);
  EXPECT_EQ(counter.count(), -5);
  EXPECT_EQ(counter.illegal(), 0);
  // Count 10 began at 0.1 mm and is left at once, count 9 after another 0.01 mm.
  ASSERT_EQ(back.size(), 15U);
  EXPECT_EQ(back[0].tick, kQuantum + 1);
  EXPECT_NEAR(static_cast<double>(back[1].tick - kQuantum), kCountMm / 300.0 * 16e6, 1.0);
}

TEST(BeltSensors, WhatAForecastPromisedTooEarlyIsTakenBackAtOnce) {
  auto sensors = encoder();
  QuadratureCounter counter;
  for (const SensorEdge& e : sensors.edges({0, 0.0, 21.0, 0.0}, kQuantum)) counter.apply(e);
  EXPECT_EQ(counter.count(), 1);
  // The belt stopped short of it.
  const auto edges = sensors.edges({kQuantum, 0.0099, 0.0001, 0.0}, 2 * kQuantum);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].tick, kQuantum + 1);
  counter.apply(edges[0]);
  EXPECT_EQ(counter.count(), 0);
}

TEST(BeltSensors, NoEdgeIsLostOrDoubledOverRandomQuantaOfABeltThatRunsToAndFro) {
  const CounterRandom random(5, 9);
  BeltSensors sensors(kRate, kCountMm, print(4), 1.0);
  QuadratureCounter counter;
  bool mark = false;
  Tick now = 0;
  double travel_mm = 0.0;
  double speed = 100.0;
  long long edges_seen = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Tick until = now + 1 + random.bits(3 * i) % 10000;
    const double acceleration = 1500.0 * random.normal(3 * i + 1) - 4.0 * (speed - 40.0);
    // The forecast knows the acceleration only roughly.
    const double guessed = acceleration + 200.0 * random.normal(3 * i + 2);
    const double begin_mm = travel_mm;
    Tick last = now;
    for (const SensorEdge& e : sensors.edges({now, travel_mm, speed, guessed}, until)) {
      ASSERT_GT(e.tick, now);
      ASSERT_LE(e.tick, until);
      ASSERT_GE(e.tick, last);
      last = e.tick;
      if (e.signal == Signal::kPrintMark) {
        ASSERT_NE(e.level, mark);
        mark = e.level;
      } else {
        counter.apply(e);
        ++edges_seen;
      }
    }
    const double dt = kRate.seconds(until - now);
    travel_mm += speed * dt + 0.5 * acceleration * dt * dt;
    speed += acceleration * dt;
    now = until;
    const double forecast_mm = begin_mm + (speed - acceleration * dt) * dt + 0.5 * guessed * dt * dt;
    ASSERT_EQ(counter.count(), static_cast<long long>(std::floor(forecast_mm / kCountMm)));
    double place = forecast_mm - 1.0;
    const bool under = place >= 0 && place < 200.0 && std::fmod(place, 50.0) < 4.0;
    ASSERT_EQ(mark, under) << forecast_mm;
  }
  EXPECT_EQ(counter.illegal(), 0);
  EXPECT_GT(edges_seen, 10000);
  EXPECT_GT(travel_mm, 200.0);
}

TEST(BeltSensors, TheEyeMarkOfEachUnitComesAndGoesAtItsTravel) {
  BeltSensors sensors(kRate, kCountMm, print(3), 7.0);
  constexpr double kSpeed = 80.0;
  std::vector<SensorEdge> marks;
  for (Tick now = 0; now < 3 * kRate.den; now += kQuantum) {
    for (const SensorEdge& e :
         sensors.edges({now, kSpeed * kRate.seconds(now), kSpeed, 0.0}, now + kQuantum)) {
      if (e.signal == Signal::kPrintMark) marks.push_back(e);
    }
  }
  ASSERT_EQ(marks.size(), 6U);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double at_mm = 7.0 + 50.0 * static_cast<double>(i / 2) + (i % 2 == 0 ? 0.0 : 4.0);
    EXPECT_EQ(marks[i].level, i % 2 == 0);
    EXPECT_NEAR(static_cast<double>(marks[i].tick), at_mm / kSpeed * 16e6, 1.001);
  }
}

TEST(BeltSensors, AMarkThatRunsBackUnderTheSensorIsSeenAgain) {
  BeltSensors sensors(kRate, kCountMm, print(1), 0.02);
  const auto marksOf = [&](const BeltForecast& forecast) {
    std::vector<bool> levels;
    for (const SensorEdge& e : sensors.edges(forecast, forecast.now + kQuantum)) {
      if (e.signal == Signal::kPrintMark) levels.push_back(e.level);
    }
    return levels;
  };
  EXPECT_EQ(marksOf({0, 0.0, 100.0, 0.0}), std::vector<bool>{true});
  EXPECT_EQ(marksOf({kQuantum, 0.05, -100.0, 0.0}), std::vector<bool>{false});
  EXPECT_EQ(marksOf({2 * kQuantum, 0.0, 10000.0, 0.0}), (std::vector<bool>{true, false}));
  EXPECT_EQ(marksOf({3 * kQuantum, 5.0, -10000.0, 0.0}), (std::vector<bool>{true, false}));
}

TEST(BeltSensors, AMarkThatHasPassedBeforeTheStartIsNotSeenAndOneUnderTheSensorIs) {
  BeltSensors passed(kRate, kCountMm, print(1), -10.0);
  EXPECT_TRUE(passed.edges({0, 0.0, 10.0, 0.0}, kQuantum).empty());
  BeltSensors under(kRate, kCountMm, print(1), -2.0);
  const auto edges = under.edges({0, 0.0, 10.0, 0.0}, kQuantum);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].tick, 1U);
  EXPECT_TRUE(edges[0].level);
}

}  // namespace
}  // namespace kerfbench::twin

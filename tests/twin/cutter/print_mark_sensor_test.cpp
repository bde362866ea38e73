// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/print_mark_sensor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

PrintLayout print(int units) {
  PrintLayout result;
  result.units = units;
  result.pitch_mm = 50.0;
  result.eye_mark_length_mm = 4.0;
  return result;
}

std::vector<SensorEdge> edgesOf(PrintMarkSensor& sensor, const MotionForecast& sheet, Tick until) {
  std::vector<SensorEdge> edges;
  sensor.predict(sheet, until, edges);
  return edges;
}

// Places at which the edges are seen by a sensor over a sheet that runs from `from_mm` at a steady speed.
std::vector<double> seen(PrintMarkSensor& sensor, double speed_mm_s, double from_mm, double travel_mm) {
  std::vector<double> places;
  for (Tick now = 0; kRate.seconds(now) * std::abs(speed_mm_s) < travel_mm; now += kQuantum) {
    const double at_mm = from_mm + speed_mm_s * kRate.seconds(now);
    for (const SensorEdge& e : edgesOf(sensor, {now, at_mm, speed_mm_s, 0.0}, now + kQuantum)) {
      places.push_back(from_mm + speed_mm_s * kRate.seconds(e.tick));
    }
  }
  return places;
}

TEST(PrintMarkSensor, TheEyeMarkOfEachUnitComesAndGoesAtItsTravel) {
  PrintMarkSensor sensor(kRate, {}, print(3), 7.0, 1);
  constexpr double kSpeed = 80.0;
  std::vector<SensorEdge> marks;
  for (Tick now = 0; now < 3 * kRate.den; now += kQuantum) {
    sensor.predict({now, kSpeed * kRate.seconds(now), kSpeed, 0.0}, now + kQuantum, marks);
  }
  ASSERT_EQ(marks.size(), 6U);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double at_mm = 7.0 + 50.0 * static_cast<double>(i / 2) + (i % 2 == 0 ? 0.0 : 4.0);
    EXPECT_EQ(marks[i].signal, Signal::kPrintMark);
    EXPECT_EQ(marks[i].level, i % 2 == 0);
    EXPECT_NEAR(static_cast<double>(marks[i].tick), at_mm / kSpeed * 16e6, 1.001);
  }
}

TEST(PrintMarkSensor, AMarkThatRunsBackUnderTheSensorIsSeenAgain) {
  PrintMarkSensor sensor(kRate, {}, print(1), 0.02, 1);
  const auto levels = [&](const MotionForecast& forecast) {
    std::vector<bool> result;
    for (const SensorEdge& e : edgesOf(sensor, forecast, forecast.now + kQuantum)) result.push_back(e.level);
    return result;
  };
  EXPECT_EQ(levels({0, 0.0, 100.0, 0.0}), std::vector<bool>{true});
  EXPECT_EQ(levels({kQuantum, 0.05, -100.0, 0.0}), std::vector<bool>{false});
  EXPECT_EQ(levels({2 * kQuantum, 0.0, 10000.0, 0.0}), (std::vector<bool>{true, false}));
  EXPECT_EQ(levels({3 * kQuantum, 5.0, -10000.0, 0.0}), (std::vector<bool>{true, false}));
}

TEST(PrintMarkSensor, AMarkThatHasPassedBeforeTheStartIsNotSeenAndOneUnderTheSensorIs) {
  PrintMarkSensor passed(kRate, {}, print(1), -10.0, 1);
  EXPECT_TRUE(edgesOf(passed, {0, 0.0, 10.0, 0.0}, kQuantum).empty());
  PrintMarkSensor under(kRate, {}, print(1), -2.0, 1);
  const auto edges = edgesOf(under, {0, 0.0, 10.0, 0.0}, kQuantum);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].tick, 1U);
  EXPECT_TRUE(edges[0].level);
}

TEST(PrintMarkSensor, TheLevelIsThatOfTheMarkOverRandomQuantaOfASheetThatRunsToAndFro) {
  const CounterRandom random(5, 9);
  PrintMarkSensor sensor(kRate, {}, print(4), 1.0, 1);
  bool mark = false;
  Tick now = 0;
  double travel_mm = 0.0;
  double speed = 100.0;
  int edges_seen = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Tick until = now + 1 + random.bits(3 * i) % 10000;
    const double acceleration = 1500.0 * random.normal(3 * i + 1) - 4.0 * (speed - 40.0);
    const MotionForecast forecast{now, travel_mm, speed, acceleration};
    for (const SensorEdge& e : edgesOf(sensor, forecast, until)) {
      ASSERT_GT(e.tick, now);
      ASSERT_LE(e.tick, until);
      ASSERT_NE(e.level, mark);
      mark = e.level;
      ++edges_seen;
    }
    const double dt = kRate.seconds(until - now);
    travel_mm = forecast.placeAfter_mm(dt);
    speed += acceleration * dt;
    now = until;
    const double place = travel_mm - 1.0;
    ASSERT_EQ(mark, place >= 0 && place < 200.0 && std::fmod(place, 50.0) < 4.0) << travel_mm;
  }
  EXPECT_GE(edges_seen, 8);
}

TEST(PrintMarkSensor, EachEdgeIsSeenOffItsPlaceByTheJitterOfItsOwnAndWhereverItPassesAgain) {
  constexpr double kJitter = 0.05;
  constexpr double kSpeed = 100.0;
  PrintMarkSensor sensor(kRate, {.jitter_mm = kJitter}, print(400), 1.0, 8);
  const auto there = seen(sensor, kSpeed, 0.0, 20010.0);
  ASSERT_EQ(there.size(), 800U);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const double off = there[i] - (1.0 + 50.0 * static_cast<double>(i / 2) + (i % 2 == 0 ? 0.0 : 4.0));
    sum += off;
    squares += off * off;
  }
  EXPECT_NEAR(sum / 800.0, 0.0, 4.0 * kJitter / std::sqrt(800.0));
  EXPECT_NEAR(std::sqrt(squares / 800.0), kJitter, 4.0 * kJitter / std::sqrt(1600.0));
  const auto back = seen(sensor, -kSpeed, 20010.0, 20010.0);
  ASSERT_EQ(back.size(), 800U);
  for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], there[799 - i], 2e-5) << i;
  PrintMarkSensor other(kRate, {.jitter_mm = kJitter}, print(400), 1.0, 9);
  EXPECT_NE(seen(other, kSpeed, 0.0, 20010.0), there);
}

TEST(PrintMarkSensor, BackwardsAnEdgeIsSeenLaterByTheHysteresis) {
  constexpr double kHysteresis = 0.3;
  PrintMarkSensor sensor(kRate, {.hysteresis_mm = kHysteresis}, print(1), 2.0, 1);
  const auto there = seen(sensor, 50.0, 0.0, 10.0);
  const auto back = seen(sensor, -50.0, 10.0, 10.0);
  ASSERT_EQ(there.size(), 2U);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_NEAR(there[0], 2.0, 1e-5);
  EXPECT_NEAR(there[1], 6.0, 1e-5);
  EXPECT_NEAR(back[0], 6.0 - kHysteresis, 1e-5);
  EXPECT_NEAR(back[1], 2.0 - kHysteresis, 1e-5);
}

}  // namespace
}  // namespace kerfbench::twin

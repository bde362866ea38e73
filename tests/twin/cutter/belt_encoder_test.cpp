// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/belt_encoder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kCountMm = 0.01;
constexpr double kRadiusMm = 30.0;
constexpr Tick kQuantum = 8000;  // 0.5 ms
const EncoderDescription kPerfect{.count_mm = kCountMm};

BeltEncoder encoder(const EncoderDescription& description = kPerfect, std::uint64_t seed = 1) {
  return {kRate, description, kRadiusMm, seed};
}

std::vector<SensorEdge> edgesOf(BeltEncoder& encoder, const MotionForecast& roller, Tick until) {
  std::vector<SensorEdge> edges;
  encoder.predict(roller, until, edges);
  return edges;
}

// Edges of a belt that runs steadily over `travel_mm`, in quanta.
std::vector<SensorEdge> steady(BeltEncoder& encoder, double speed_mm_s, double from_mm, double travel_mm) {
  std::vector<SensorEdge> edges;
  for (Tick now = 0; kRate.seconds(now) * std::abs(speed_mm_s) < travel_mm; now += kQuantum) {
    encoder.predict({now, from_mm + speed_mm_s * kRate.seconds(now), speed_mm_s, 0.0}, now + kQuantum, edges);
  }
  return edges;
}

TEST(BeltEncoder, ForwardALeadsB) {
  auto sensor = encoder();
  const auto edges = edgesOf(sensor, {0, 0.0, 100.0, 0.0}, kQuantum);  // Travel of 0.05 mm: counts 1 … 5.
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

TEST(BeltEncoder, EachCountComesWithinATickOfItsPlaceOnTheBelt) {
  for (const double acceleration : {0.0, 4000.0, -4000.0}) {
    auto sensor = encoder();
    const double speed = 300.0;
    const auto edges = edgesOf(sensor, {1000, 0.0, speed, acceleration}, 1000 + kQuantum);
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

TEST(BeltEncoder, ABeltThatTurnsBackCountsBack) {
  auto sensor = encoder();
  QuadratureCounter counter;
  for (const SensorEdge& e : edgesOf(sensor, {0, 0.0, 200.0, 0.0}, kQuantum)) counter.apply(e);
  EXPECT_EQ(counter.count(), 10);
  const auto back = edgesOf(sensor, {kQuantum, 0.1, -300.0, 0.0}, 2 * kQuantum);
  for (const SensorEdge& e : back) counter.apply(e);
  EXPECT_EQ(counter.count(), -5);
  EXPECT_EQ(counter.illegal(), 0);
  // Count 10 began at 0.1 mm and is left at once, count 9 after another 0.01 mm.
  ASSERT_EQ(back.size(), 15U);
  EXPECT_EQ(back[0].tick, kQuantum + 1);
  EXPECT_NEAR(static_cast<double>(back[1].tick - kQuantum), kCountMm / 300.0 * 16e6, 1.0);
}

TEST(BeltEncoder, WhatAForecastPromisedTooEarlyIsTakenBackAtOnce) {
  auto sensor = encoder();
  QuadratureCounter counter;
  for (const SensorEdge& e : edgesOf(sensor, {0, 0.0, 21.0, 0.0}, kQuantum)) counter.apply(e);
  EXPECT_EQ(counter.count(), 1);
  // The belt stopped short of the count.
  const auto edges = edgesOf(sensor, {kQuantum, 0.0099, 0.0001, 0.0}, 2 * kQuantum);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].tick, kQuantum + 1);
  counter.apply(edges[0]);
  EXPECT_EQ(counter.count(), 0);
}

TEST(BeltEncoder, NoEdgeIsLostOrDoubledOverRandomQuantaOfABeltThatRunsToAndFro) {
  for (const double jitter : {0.0, 0.2}) {
    const CounterRandom random(5, 9);
    auto sensor = encoder({.count_mm = kCountMm, .jitter_counts = jitter});
    QuadratureCounter counter;
    Tick now = 0;
    double travel_mm = 0.0;
    double speed = 100.0;
    long long edges_seen = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Tick until = now + 1 + random.bits(3 * i) % 10000;
      const double acceleration = 1500.0 * random.normal(3 * i + 1) - 4.0 * (speed - 40.0);
      // The forecast has only a rough acceleration.
      const double guessed = acceleration + 200.0 * random.normal(3 * i + 2);
      const MotionForecast forecast{now, travel_mm, speed, guessed};
      Tick last = now;
      for (const SensorEdge& e : edgesOf(sensor, forecast, until)) {
        ASSERT_GT(e.tick, now);
        ASSERT_LE(e.tick, until);
        ASSERT_GE(e.tick, last);
        last = e.tick;
        counter.apply(e);
        ++edges_seen;
      }
      const double dt = kRate.seconds(until - now);
      // A line is off its place by the jitter, and so is the place where counting began.
      const double counts = forecast.placeAfter_mm(dt) / kCountMm;
      if (jitter == 0.0) {
        ASSERT_EQ(counter.count(), static_cast<long long>(std::floor(counts)));
      } else {
        ASSERT_NEAR(static_cast<double>(counter.count()), counts - 0.5, 0.5 + 1.0 + 0.4);
      }
      travel_mm += speed * dt + 0.5 * acceleration * dt * dt;
      speed += acceleration * dt;
      now = until;
    }
    EXPECT_EQ(counter.illegal(), 0);
    EXPECT_GT(edges_seen, 10000);
    EXPECT_GT(travel_mm, 200.0);
  }
}

// Places where an encoder with this jitter sees its first lines, mm, forward.
std::vector<double> lines(const EncoderDescription& description, std::uint64_t seed, double travel_mm) {
  constexpr double kSpeed = 10.0;
  auto sensor = encoder(description, seed);
  std::vector<double> places;
  for (const SensorEdge& e : steady(sensor, kSpeed, 0.0, travel_mm)) {
    places.push_back(kSpeed * kRate.seconds(e.tick));
  }
  return places;
}

TEST(BeltEncoder, TheJitterHasTheStandardDeviationOfItsDescriptionAndIsClippedSoThatLinesKeepTheirOrder) {
  const auto places = lines({.count_mm = kCountMm, .jitter_counts = 0.1}, 7, 100.0);
  ASSERT_GT(places.size(), 9990U);
  // Counting may begin before line 0, whose place has jitter too.
  const long long first = std::llround(places.front() / kCountMm);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off = places[i] / kCountMm - static_cast<double>(first + static_cast<long long>(i));
    ASSERT_LE(std::abs(off), BeltEncoder::kMaxJitter_counts + 1e-3);
    sum += off;
    squares += off * off;
    if (i > 0) {
      ASSERT_GT(places[i], places[i - 1]);
    }
  }
  const auto n = static_cast<double>(places.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 4.0 * 0.1 / std::sqrt(2.0 * n));
}

TEST(BeltEncoder, TheLargestJitterIsClippedAtTheStatedShare) {
  const auto places = lines({.count_mm = kCountMm, .jitter_counts = 0.2}, 3, 50.0);
  const long long first = std::llround(places.front() / kCountMm);
  double worst = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    worst = std::max(worst,
                     std::abs(places[i] / kCountMm - static_cast<double>(first + static_cast<long long>(i))));
  }
  EXPECT_NEAR(worst, BeltEncoder::kMaxJitter_counts, 1e-3);  // Some 5 % of all are beyond 2 sigma.
}

TEST(BeltEncoder, ALineStandsAtTheSamePlaceWheneverTheBeltPassesIt) {
  auto sensor = encoder({.count_mm = kCountMm, .jitter_counts = 0.2, .runout_mm = 0.02});
  constexpr double kSpeed = 10.0;
  QuadratureCounter counter;
  std::map<long long, double> there;
  std::map<long long, double> back;
  for (const SensorEdge& e : steady(sensor, kSpeed, 0.0, 5.0)) {
    counter.apply(e);
    there[counter.count()] = kSpeed * kRate.seconds(e.tick);
  }
  for (const SensorEdge& e : steady(sensor, -kSpeed, 5.0, 5.0)) {
    back[counter.count()] = 5.0 - kSpeed * kRate.seconds(e.tick);
    counter.apply(e);
  }
  ASSERT_GT(back.size(), 490U);
  for (const auto& [count, place] : back) {
    if (!there.contains(count)) continue;
    EXPECT_NEAR(place, there[count], 3.0 * kSpeed / 16e6) << count;
  }
}

TEST(BeltEncoder, AnotherSeedIsAnotherDisc) {
  const EncoderDescription jittery{.count_mm = kCountMm, .jitter_counts = 0.1};
  EXPECT_EQ(lines(jittery, 4, 1.0), lines(jittery, 4, 1.0));
  EXPECT_NE(lines(jittery, 4, 1.0), lines(jittery, 5, 1.0));
  EXPECT_EQ(lines(kPerfect, 4, 1.0), lines(kPerfect, 5, 1.0));
}

TEST(BeltEncoder, AnEccentricDiscErrsOnceATurnByItsRunout) {
  constexpr double kRunout = 0.05;
  constexpr double kPhase = 0.7;
  const double turn_mm = 2.0 * std::numbers::pi * kRadiusMm;
  const auto places =
      lines({.count_mm = kCountMm, .runout_mm = kRunout, .runout_phase_rad = kPhase}, 1, 1.5 * turn_mm);
  double least = 1.0;
  double most = -1.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    // The error is the disc's excess over the truth, from the start.
    const double error = kCountMm * static_cast<double>(i + 1) - places[i];
    const double angle = places[i] / kRadiusMm + kPhase;
    ASSERT_NEAR(error, kRunout * (std::sin(angle) - std::sin(kPhase)), 2e-6) << places[i];
    least = std::min(least, error);
    most = std::max(most, error);
  }
  EXPECT_NEAR(most - least, 2.0 * kRunout, 1e-4);
}

TEST(BeltEncoder, AtTheStartBothPinsAreLowWhereverBetweenTwoLinesTheDiscStands) {
  // Some of many seeds have discs whose line 0 lies a little before and a little behind the start.
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    auto sensor = encoder({.count_mm = kCountMm, .jitter_counts = 0.2}, seed);
    EXPECT_TRUE(edgesOf(sensor, {0, 0.0, 0.0, 0.0}, kQuantum).empty()) << seed;
    QuadratureCounter counter;
    for (const SensorEdge& e : edgesOf(sensor, {kQuantum, 0.0, 100.0, 0.0}, 2 * kQuantum)) counter.apply(e);
    EXPECT_EQ(counter.illegal(), 0) << seed;
    EXPECT_GE(counter.count(), 4) << seed;
  }
}

}  // namespace
}  // namespace kerfbench::twin

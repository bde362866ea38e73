// SPDX-License-Identifier: Apache-2.0
// The largest distance of synthetic readings whose truth is known.
#include "hil/inspect/space/worst_distance.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

/// Readings along a line of 30 mm, of which each is `beside`, `above` and noise.
std::vector<EdgeReading> lineOf(double beside_mm, double above_mm, double noise_mm, std::uint64_t seed) {
  std::vector<EdgeReading> readings;
  const CounterRandom random(seed, 9);
  for (std::uint64_t i = 0; i < 300; ++i) {
    EdgeReading reading;
    reading.way_mm = kEdgePitch_mm * static_cast<double>(i);
    reading.found = reading.open = reading.strict = true;
    reading.beside_mm = beside_mm + noise_mm * random.normal(i);
    reading.above_mm = above_mm;
    reading.noise_mm = noise_mm;
    reading.beside_modes = reading.above_modes = Eigen::VectorXd::Zero(1);
    reading.sources = {kBySurvey};
    readings.push_back(reading);
  }
  return readings;
}

TEST(WorstDistance, IsTheDistanceInSpaceAndNotInTheFace) {
  const WorstDistance worst = worstDistance(lineOf(0.03, 0.04, 0.0, 1), 1);
  EXPECT_NEAR(worst.value.value, 0.05, 1e-6);
  EXPECT_EQ(worst.readings, 300U);
}

TEST(WorstDistance, ItsIntervalHoldsTheTruth) {
  int held = 0;
  constexpr int kCases = 60;
  for (int i = 0; i < kCases; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const WorstDistance worst = worstDistance(lineOf(0.02, 0.01, 0.004, seed), seed);
    if (std::abs(worst.value.value - std::hypot(0.02, 0.01)) <= worst.value.U) ++held;
    // The largest of 300 is too large by more than that.
    EXPECT_GT(worst.as_read_mm, std::hypot(0.02, 0.01) + 0.002);
  }
  EXPECT_GE(held, kCases * 9 / 10);
}

TEST(WorstDistance, WhatReadingsHaveInCommonIsAddedToU) {
  std::vector<EdgeReading> readings = lineOf(0.0, 0.04, 0.0, 1);
  for (EdgeReading& reading : readings) {
    reading.beside_modes = Eigen::VectorXd::Constant(1, 0.001);
    reading.above_modes = Eigen::VectorXd::Constant(1, 0.007);
  }
  const WorstDistance worst = worstDistance(readings, 1);
  EXPECT_NEAR(worst.value.U, 2.0 * 0.007, 1e-4);
  EXPECT_NEAR(worst.source_u_mm[kBySurvey], 0.007, 1e-6);
}

TEST(WorstDistance, ANotchOfThreeReadingsKeepsItsHeight) {
  std::vector<EdgeReading> readings = lineOf(0.0, 0.0, 0.0005, 1);
  for (const std::size_t i : {150U, 151U, 152U}) readings[i].beside_mm -= 0.1;
  const WorstDistance worst = worstDistance(readings, 1);
  EXPECT_NEAR(worst.as_read_mm, 0.1, 0.002);
  EXPECT_GT(worst.value.value + worst.value.U, 0.098);
}

TEST(WorstDistance, OnlyWhatLiesAlongTheContourCounts) {
  std::vector<EdgeReading> readings = lineOf(0.0, 0.0, 0.0, 1);
  readings[10].zone = EdgeZone::kJoint;
  readings[10].beside_mm = 1.0;
  readings[20].found = false;
  readings[20].beside_mm = 1.0;
  EXPECT_LT(worstDistance(readings, 1).value.value, 1e-9);
  EXPECT_FALSE(std::isfinite(worstDistance({}, 1).value.value));
}

}  // namespace
}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
// A leg of kerf near a joint, from calipers made by hand.
#include "hil/vision/kerf/kerf_leg.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

constexpr double kPitch_mm = 0.05;
constexpr double kSigma_mm = 0.001;

/// A straight kerf that leaves its line by `slope`, with noise that four neighbours have in common, as
/// overlapping windows have.
EntityKerf kerfOf(std::uint64_t seed, double slope) {
  const CounterRandom noise(seed, 1);
  EntityKerf kerf;
  for (std::uint64_t i = 0; i < 60; ++i) {
    Caliper c;
    c.found = true;
    c.station_mm = kPitch_mm * static_cast<double>(i);
    for (std::uint64_t k = 0; k < 4; ++k) c.offset_mm += 0.5 * kSigma_mm * noise.normal(i + k);
    c.offset_mm += slope * c.station_mm;
    c.sigma_mm = kSigma_mm;
    c.width_mm = 0.2;
    c.brightness = 1.0;
    kerf.calipers.push_back(c);
  }
  return kerf;
}

TEST(KerfLeg, IsCarriedOnToItsJoint) {
  constexpr int kLegs = 400;
  double mean_mm = 0.0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= kLegs; ++seed) {
    const auto leg = legAt(kerfOf(seed, 0.02), 0.0, 0.3);
    ASSERT_TRUE(leg.has_value());
    EXPECT_NEAR(leg->half_width_mm, 0.1, 1e-12);
    EXPECT_NEAR(leg->sigma_mm, kSigma_mm, 1e-12);
    mean_mm += leg->offset_mm / kLegs;
    squares += leg->offset_mm * leg->offset_mm / kLegs;
  }
  // The line goes through readings from 0.3 to 2 mm, nine of which are independent, and is extended to 0.
  EXPECT_LT(std::abs(mean_mm), 1e-4);
  EXPECT_LT(std::sqrt(squares), 1.2 * kSigma_mm);
}

TEST(KerfLeg, FlickersByWhatItsWidthVariesBeyondNoise) {
  EntityKerf kerf = kerfOf(1, 0.0);
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
    kerf.calipers[i].width_mm += i % 2 == 0 ? 0.004 : -0.004;
    kerf.calipers[i].width_sigma_mm = 0.001;
  }
  EXPECT_NEAR(legAt(kerf, 0.0, 0.3)->flicker_mm, std::sqrt(0.002 * 0.002 - 0.5 * 0.0005 * 0.0005), 5e-5);
  for (Caliper& c : kerf.calipers) c.width_sigma_mm = 0.009;
  EXPECT_EQ(legAt(kerf, 0.0, 0.3)->flicker_mm, 0.0);
}

TEST(KerfLeg, FlickersNoLessForFewerReadings) {
  // Four readings, by turns 4 um wider and narrower: half a width scatters by 2 um, times sqrt(4 / 3) for so
  // few.
  EntityKerf kerf = kerfOf(1, 0.0);
  kerf.calipers = {kerf.calipers.begin() + 6, kerf.calipers.begin() + 10};
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i)
    kerf.calipers[i].width_mm += i % 2 == 0 ? 0.004 : -0.004;
  EXPECT_NEAR(legAt(kerf, 0.0, 0.25)->flicker_mm, 0.002 * std::sqrt(4.0 / 3.0), 1e-9);
}

TEST(KerfLeg, HasNoReadingsOfAnotherJointOrOfNothing) {
  EntityKerf kerf = kerfOf(1, 0.0);
  for (std::size_t i = 0; i < 8; ++i) kerf.calipers[i].near_joint = true;
  kerf.calipers[12].found = false;
  const auto readings = readingsBeside(kerf, 0.0, 0.3, 1.0);
  ASSERT_EQ(readings.size(), 12U);
  EXPECT_DOUBLE_EQ(readings.front().away_mm, 0.4);
  EXPECT_DOUBLE_EQ(readings.back().away_mm, 1.0);
}

TEST(KerfLeg, IsFollowedByAPolynomialOfAnyDegree) {
  std::vector<LegReading> readings;
  for (const double s : {0.4, 0.5, 0.7, 1.0, 1.2})
    readings.push_back({s, 0.01 - 0.2 * s + 0.3 * s * s - 0.05 * s * s * s, 0.001});
  const Eigen::VectorXd c = polynomialThrough(readings, 3);
  EXPECT_LT((c - Eigen::Vector4d(0.01, -0.2, 0.3, -0.05)).norm(), 1e-9);
}

}  // namespace
}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
// A leg of kerf beside a joint, from calipers made by hand.
#include "hil/vision/kerf_leg.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::hil {
namespace {

constexpr double kPitch_mm = 0.05;
constexpr double kSigma_mm = 0.001;

/// A straight kerf that leaves its line by `slope`, with noise that four neighbours have in common, as
/// windows that overlap have.
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

TEST(KerfLeg, IsCarriedOnToItsJointWithAnHonestUncertainty) {
  constexpr int kLegs = 400;
  double z2 = 0.0;
  double mean_z = 0.0;
  for (std::uint64_t seed = 1; seed <= kLegs; ++seed) {
    const auto leg = legAt(kerfOf(seed, 0.02), 0.0, 0.3);
    ASSERT_TRUE(leg.has_value());
    const double z = leg->offset_mm / leg->offset_sigma_mm;
    z2 += z * z / kLegs;
    mean_z += z / kLegs;
  }
  std::printf("  z %.2f, mean %.2f\n", std::sqrt(z2), mean_z);
  EXPECT_LT(std::abs(mean_z), 0.2);
  EXPECT_GT(std::sqrt(z2), 0.8);
  EXPECT_LT(std::sqrt(z2), 1.2);
}

}  // namespace
}  // namespace kerfbench::hil

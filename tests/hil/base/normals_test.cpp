// SPDX-License-Identifier: Apache-2.0
// Many normal values at once, compared with the distribution and with the standard library's functions.
#include "twin/base/normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench {
namespace {

constexpr std::size_t kCount = 1'000'000;

std::vector<double> manyNormals() {
  std::vector<double> values(kCount);
  fillNormals(CounterRandom(5, 9), 0, values);
  return values;
}

TEST(Normals, AreWhatBoxAndMullerSayOfTheSameBits) {
  constexpr std::size_t kFew = 20'000;
  const CounterRandom random(5, 9);
  std::vector<double> values(kFew);
  fillNormals(random, 7, values);
  for (std::size_t pair = 0; pair < kFew / 2; ++pair) {
    const std::uint64_t bits = random.bits(7 + pair);
    const double u = 1.0 - static_cast<double>(bits >> 32U) * 0x1.0p-32;
    const double radius = std::sqrt(-2.0 * std::log(u));
    EXPECT_NEAR(std::hypot(values[2 * pair], values[2 * pair + 1]), radius, 1e-10 * (1.0 + radius));
    const double quarter =
        0.5 * std::numbers::pi * (static_cast<double>(bits & 0xffffffffU) * 0x1.0p-32 - 0.5);
    const double along = ((bits & 1U) != 0 ? -1.0 : 1.0) * radius * std::cos(quarter);
    const double across = radius * std::sin(quarter);
    const bool swapped = (bits & 2U) != 0;
    EXPECT_NEAR(values[2 * pair], swapped ? across : along, 1e-10 * (1.0 + radius));
    EXPECT_NEAR(values[2 * pair + 1], swapped ? along : across, 1e-10 * (1.0 + radius));
  }
}

TEST(Normals, LieNoFartherFromTheDistributionThanChanceHasIt) {
  std::vector<double> values = manyNormals();
  std::sort(values.begin(), values.end());
  double farthest = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double below = 0.5 * std::erfc(-values[i] / std::numbers::sqrt2);
    farthest = std::max(farthest, std::abs(below - (static_cast<double>(i) + 0.5) / kCount));
  }
  EXPECT_LT(farthest, 1.95 / std::sqrt(kCount));  // Kolmogorov and Smirnov: one in a thousand is farther.
  // The tails, which extremes are made of: four standard deviations of a count.
  const double beyond4 = static_cast<double>(
      std::count_if(values.begin(), values.end(), [](double v) { return std::abs(v) > 4.0; }));
  const double expected = kCount * std::erfc(4.0 / std::numbers::sqrt2);
  EXPECT_NEAR(beyond4, expected, 4.0 * std::sqrt(expected));
}

TEST(Normals, TheTwoOfAPairAndNeighboursAreIndependent) {
  const std::vector<double> values = manyNormals();
  double with_next = 0.0;
  double squares_with_next = 0.0;
  for (std::size_t i = 0; i + 1 < kCount; ++i) {
    with_next += values[i] * values[i + 1] / kCount;
    squares_with_next += (values[i] * values[i] - 1.0) * (values[i + 1] * values[i + 1] - 1.0) / kCount;
  }
  EXPECT_NEAR(with_next, 0.0, 4.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares_with_next, 0.0, 4.0 * 2.0 / std::sqrt(kCount));
}

TEST(Normals, DependOnTheCounterAloneNotOnHowManyAreAskedFor) {
  const std::vector<double> all = manyNormals();
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{127}, std::size_t{128},
                                  std::size_t{129}, std::size_t{1000}}) {
    std::vector<double> some(count);
    fillNormals(CounterRandom(5, 9), 0, some);
    EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin())) << count;
  }
  std::vector<double> later(10);
  fillNormals(CounterRandom(5, 9), 50, later);
  EXPECT_TRUE(std::equal(later.begin(), later.end(), all.begin() + 100));
}

}  // namespace
}  // namespace kerfbench

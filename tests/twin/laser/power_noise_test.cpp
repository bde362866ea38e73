// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/power_noise.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

TEST(PowerNoise, HasItsDeviationAndItsCorrelation) {
  PowerNoise noise(0.02, 1e-3, 11);
  const double step_s = 50e-6;
  std::vector<double> values;
  for (int i = 0; i < 1'000'000; ++i) values.push_back(noise.meanOver(i * step_s, i * step_s + 1e-7));
  const auto correlation = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i + lag < values.size(); ++i) sum += values[i] * values[i + lag];
    return sum / static_cast<double>(values.size() - lag) / (0.02 * 0.02);
  };
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  // The relative error after 50 000 correlation times is sqrt(1 / 50 000) = 0.45 % for the variance, 0.63 %
  // for the mean.
  EXPECT_NEAR(mean, 0.0, 4.0 * 0.0063 * 0.02);
  // A straight line between two knots has less variance.
  const double lost = (1.0 - std::exp(-1.0 / 8.0)) / 3.0;
  EXPECT_NEAR(correlation(0), 1.0 - lost, 0.018);
  EXPECT_NEAR(correlation(10), std::exp(-0.5), 0.018);
  EXPECT_NEAR(correlation(20), std::exp(-1.0), 0.018);
  EXPECT_NEAR(correlation(60), std::exp(-3.0), 0.018);
}

TEST(PowerNoise, MeansOfPartsAreTheMeanOfTheWhole) {
  PowerNoise parts(0.1, 1e-3, 3);
  PowerNoise whole(0.1, 1e-3, 3);
  double begin_s = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double length_s = 1e-5 * (1 + i % 50);  // The length is up to four knots.
    double sum = 0.0;
    for (int k = 0; k < 10; ++k) {
      sum += parts.meanOver(begin_s + 0.1 * k * length_s, begin_s + 0.1 * (k + 1) * length_s) / 10.0;
    }
    EXPECT_NEAR(whole.meanOver(begin_s, begin_s + length_s), sum, 1e-12);
    begin_s += length_s;
  }
}

TEST(PowerNoise, IsAFunctionOfTimeAlone) {
  PowerNoise forth(0.1, 1e-3, 3);
  PowerNoise back(0.1, 1e-3, 3);
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(forth.meanOver(i * 1e-3, i * 1e-3 + 1e-5));
  for (int i = 99; i >= 0; --i) {
    EXPECT_EQ(back.meanOver(i * 1e-3, i * 1e-3 + 1e-5), values[static_cast<std::size_t>(i)]);
  }
}

TEST(PowerNoise, WithoutADeviationIsSilent) {
  PowerNoise noise(0.0, 1e-3, 3);
  EXPECT_TRUE(noise.silent());
  EXPECT_EQ(noise.meanOver(0.5, 0.6), 0.0);
}

}  // namespace
}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
// Simulated measurements of a line, compared with the noise that its readings state.
#include "hil/inspect/deviation/simulated_line.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::inspect {
namespace {

constexpr std::size_t kFewReadings = 10;
constexpr std::size_t kSecondSegment = 4;  ///< First reading behind a gap.
constexpr int kDraws = 4000;
// Standard deviation of a variance, and of a correlation, of so many draws, times four.
const double kFourSigmas_variance = 4.0 * std::sqrt(2.0 / kDraws);
const double kFourSigmas_correlation = 4.0 / std::sqrt(kDraws);

ReadingLine lineWithAGap() {
  ReadingLine line;
  line.q = 0.6;
  for (std::size_t i = 0; i < kFewReadings; ++i) {
    line.reading_mm.push_back(0.0);
    line.sigma_mm.push_back(0.001 * (1.0 + static_cast<double>(i)));
    line.caliper.push_back(i);
  }
  line.segment = {0, kSecondSegment, kFewReadings};
  line.shared.setZero(kFewReadings, ReadingLine::kOwn);
  return line;
}

/// Errors of each simulated reading, in its stated standard deviation.
std::vector<std::vector<double>> errorsOf(const ReadingLine& line) {
  SimulatedLine simulated(line, LineKind{});
  std::vector<std::vector<double>> errors(line.size());
  const Eigen::VectorXd nothing_shared = Eigen::VectorXd::Zero(line.shared.cols());
  for (int draw = 0; draw < kDraws; ++draw) {
    simulated.measure(CounterRandom(16, static_cast<std::uint64_t>(draw)), 0, nothing_shared);
    for (std::size_t i = 0; i < line.size(); ++i)
      errors[i].push_back((simulated.reading_mm[i] - simulated.likely_mm[i]) / line.sigma_mm[i]);
  }
  return errors;
}

double meanProduct(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

TEST(SimulatedLine, EachReadingScattersAsItStates) {
  const auto errors = errorsOf(lineWithAGap());
  for (std::size_t i = 0; i < kFewReadings; ++i)
    EXPECT_NEAR(meanProduct(errors[i], errors[i]), 1.0, kFourSigmas_variance) << "reading " << i;
}

TEST(SimulatedLine, NeighboursShareNoiseButNotAcrossAGap) {
  const auto errors = errorsOf(lineWithAGap());
  for (std::size_t i = 1; i < kFewReadings; ++i) {
    EXPECT_NEAR(meanProduct(errors[i - 1], errors[i]), i == kSecondSegment ? 0.0 : 0.6,
                kFourSigmas_correlation)
        << "reading " << i;
  }
}

TEST(SimulatedLine, HoldsAllThatTheUnitAndItsTilesShareAndAShareOfTheNoise) {
  ReadingLine line = lineWithAGap();
  for (std::size_t i = 0; i < kFewReadings; ++i) line.reading_mm[i] = i % 3 == 0 ? 0.02 : -0.01;
  line.tiles = 2;
  line.shared.setZero(kFewReadings, ReadingLine::kOwn + line.tiles + 1);
  line.shared.col(ReadingLine::kLine).setConstant(0.02);
  line.shared.col(ReadingLine::kOwn).setConstant(0.01);
  line.shared.col(ReadingLine::kOwn + line.tiles)
      .setConstant(0.5);  // The camera's, which all lines have alike.
  const SimulatedLine simulated(line, LineKind{});
  ASSERT_GT(simulated.noise_share, 0.1);
  ASSERT_LT(simulated.noise_share, 0.9);
  constexpr double kShared = 0.02 * 0.02 + 0.01 * 0.01;
  for (std::size_t i = 0; i < kFewReadings; ++i) {
    const double noise = std::pow(simulated.smoother().sigma(i, simulated.level[i]), 2);
    EXPECT_NEAR(simulated.errorShareAt(i) * (noise + kShared), simulated.noise_share * noise + kShared,
                1e-12);
  }
}

TEST(SimulatedLine, WithoutAnyErrorItHoldsAllOfIt) {
  ReadingLine line = lineWithAGap();
  for (double& sigma_mm : line.sigma_mm) sigma_mm = 0.0;
  EXPECT_EQ(SimulatedLine(line, LineKind{}).errorShareAt(2), 1.0);
}

}  // namespace
}  // namespace kerfbench::inspect

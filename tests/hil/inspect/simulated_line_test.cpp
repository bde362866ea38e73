// SPDX-License-Identifier: Apache-2.0
// Simulated measurements of a line, compared with the noise that its readings state.
#include "hil/inspect/deviation/simulated_line.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::inspect {
namespace {

constexpr std::size_t kFewReadings = 10;
constexpr std::size_t kSecondSegment = 4;  ///< First reading behind a gap.
constexpr std::uint64_t kDraws = 4000;
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

std::array<CounterRandom, kDrawsAtOnce> streamsFrom(std::uint64_t draw) {
  std::array<CounterRandom, kDrawsAtOnce> streams{CounterRandom(16, draw),     CounterRandom(16, draw + 1),
                                                  CounterRandom(16, draw + 2), CounterRandom(16, draw + 3),
                                                  CounterRandom(16, draw + 4), CounterRandom(16, draw + 5),
                                                  CounterRandom(16, draw + 6), CounterRandom(16, draw + 7)};
  return streams;
}

/// Errors of each simulated reading, in its stated standard deviation.
std::vector<std::vector<double>> errorsOf(const ReadingLine& line) {
  const SimulatedLine simulated(line, LineKind{});
  SimulatedReadings readings;
  std::vector<std::vector<double>> errors(line.size());
  for (std::uint64_t draw = 0; draw < kDraws; draw += kDrawsAtOnce) {
    simulated.measure(streamsFrom(draw), 0, {}, readings);
    for (std::size_t i = 0; i < line.size(); ++i) {
      for (const double reading_mm : readings.reading_mm[i])
        errors[i].push_back((reading_mm - simulated.likely_mm[i]) / line.sigma_mm[i]);
    }
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
  line.tiles = {0, 1};
  line.shared.setZero(kFewReadings, ReadingLine::kOwn + line.tileColumns() + 1);
  line.shared.col(ReadingLine::kLine).setConstant(0.02);
  line.shared.col(ReadingLine::kOwn).setConstant(0.01);
  line.shared.col(ReadingLine::kOwn + line.tileColumns())
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

TEST(SimulatedLine, EachDrawHasItsSharedErrorsAndIsSmoothedByItself) {
  ReadingLine line = lineWithAGap();
  for (std::size_t i = 0; i < kFewReadings; ++i) {
    line.reading_mm[i] = 1e-3 * static_cast<double>(i);
    line.sigma_mm[i] = 0.0;
  }
  line.shared.col(2).setLinSpaced(0.01, 0.02);
  line.shared.col(ReadingLine::kLine)[1] = 0.04;
  const SimulatedLine simulated(line, LineKind{});
  ASSERT_EQ(simulated.columns(), (std::vector<Eigen::Index>{2, ReadingLine::kLine}));
  std::array<Draws, 2> errors{};
  for (std::size_t d = 0; d < kDrawsAtOnce; ++d) errors[0][d] = 1.0 + static_cast<double>(d);
  errors[1][3] = -2.0;
  SimulatedReadings readings;
  simulated.measure(streamsFrom(0), 0, errors, readings);
  const Draws worst = largestOf(readings.simulated_mm);
  const Draws squares = sumOfSquares(readings.reading_mm, LineKind::Rms::kAboutMean);
  for (std::size_t d = 0; d < kDrawsAtOnce; ++d) {
    std::vector<double> alone(kFewReadings);
    for (std::size_t i = 0; i < kFewReadings; ++i) {
      alone[i] = simulated.likely_mm[i] +
                 line.shared(static_cast<Eigen::Index>(i), 2) * (1.0 + static_cast<double>(d));
      if (i == 1 && d == 3) alone[i] -= 2.0 * 0.04;
      EXPECT_NEAR(readings.reading_mm[i][d], alone[i], 1e-12);
    }
    std::vector<double> smooth;
    simulated.smoother().apply(alone, simulated.level, smooth);
    EXPECT_NEAR(worst[d], largestOf(smooth), 1e-12);
    EXPECT_NEAR(squares[d], sumOfSquares(alone, LineKind::Rms::kAboutMean), 1e-12);
  }
}

TEST(SimulatedLine, ADrawThatIsNoNumberIsToldAndLeavesTheOthers) {
  std::vector<Draws> values(3);
  values[0].fill(0.5);
  values[1][4] = std::numeric_limits<double>::quiet_NaN();
  values[2].fill(-0.25);
  const Draws most = largestOf(values);
  for (std::size_t d = 0; d < kDrawsAtOnce; ++d) EXPECT_EQ(std::isnan(most[d]), d == 4) << d;
  EXPECT_EQ(most[0], 0.5);
}

TEST(SimulatedLine, WithoutAnyErrorItHoldsAllOfIt) {
  ReadingLine line = lineWithAGap();
  for (double& sigma_mm : line.sigma_mm) sigma_mm = 0.0;
  EXPECT_EQ(SimulatedLine(line, LineKind{}).errorShareAt(2), 1.0);
}

}  // namespace
}  // namespace kerfbench::inspect

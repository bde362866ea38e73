// SPDX-License-Identifier: Apache-2.0
// The largest deviation of many readings, its uncertainty, and the budget of it without simulation.
#include "hil/inspect/deviation/worst_deviation.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "hil/inspect/deviation/extreme_budget.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

constexpr Eigen::Index kModes = 1;
constexpr Eigen::Index kFirstMode = ReadingLine::kOwn;

Eigen::RowVectorXd errors(double pose_mm, double camera_mm) {
  Eigen::RowVectorXd shared = Eigen::RowVectorXd::Zero(ReadingLine::kOwn + kModes);
  shared[ReadingLine::kLine] = pose_mm;
  shared[kFirstMode] = camera_mm;
  return shared;
}

ExtremeLine oneReading(int unit, double seen_mm, double pose_mm, double camera_mm) {
  return {unit,
          {},
          {{.likely = seen_mm,
            .seen = seen_mm,
            .sigma = 0.0005,
            .correlation = 0.0,
            .shared = errors(pose_mm, camera_mm)}}};
}

TEST(ExtremeBudget, OfALineThatStandsOutIsThatOfThatLine) {
  const ExtremeLine worst = oneReading(0, 0.100, 0.004, 0.001);
  const ExtremeLine other = oneReading(1, 0.080, 0.001, 0.003);
  for (const auto& lines : {std::vector{worst, other}, std::vector{other, worst}}) {
    const ExtremeBudget budget = extremeBudget(lines);
    EXPECT_NEAR(budget.u_pose, 0.004, 1e-5);
    EXPECT_NEAR(budget.u_camera, 0.001, 1e-5);
    EXPECT_NEAR(budget.u_noise, 0.0005, 5e-5);
    EXPECT_NEAR(budget.extreme_bias, 0.0, 1e-5);
  }
}

TEST(ExtremeBudget, TellsPoseTableAndCameraApart) {
  ExtremeLine line = oneReading(0, 0.1, 0.0, 0.0);
  line.tiles = {0};
  Eigen::RowVectorXd& shared = line.points[0].shared;
  shared = Eigen::RowVectorXd::Zero(ReadingLine::kOwn + 1 + kModes);
  shared[ReadingLine::kLine] = 0.004;
  shared[ReadingLine::kOwn] = 0.002;
  shared[ReadingLine::kOwn + 1] = 0.001;
  const ExtremeBudget budget = extremeBudget({line}, 1);
  EXPECT_NEAR(budget.u_pose, 0.004, 1e-5);
  EXPECT_NEAR(budget.u_table, 0.002, 1e-5);
  EXPECT_NEAR(budget.u_camera, 0.001, 1e-5);
}

TEST(ExtremeBudget, LinesInOneTileMoveTogetherAndThoseInOthersDoNot) {
  const auto bias = [](Eigen::Index other_tile) {
    const auto line = [](Eigen::Index tile) {
      ExtremeLine one = oneReading(0, 0.1, 0.0, 0.0);
      one.tiles = {tile};
      one.points[0].shared = Eigen::RowVectorXd::Zero(ReadingLine::kOwn + 1 + kModes);
      one.points[0].shared[ReadingLine::kOwn] = 0.004;
      return one;
    };
    return extremeBudget({line(3), line(other_tile)}, 8).extreme_bias;
  };
  EXPECT_NEAR(bias(5), std::hypot(0.004, 0.0005) / std::sqrt(std::numbers::pi), 2e-5);
  EXPECT_NEAR(bias(3), 0.0005 / std::sqrt(std::numbers::pi), 2e-5);
}

TEST(ExtremeBudget, OneReadingAloneIsNormal) {
  // The largest of one is itself: the grid of its distribution must add nothing to its mean.
  ExtremeLine line = oneReading(0, 0.1, 0.0, 0.0);
  line.points[0].sigma = 0.01;
  const ExtremeBudget budget = extremeBudget({line});
  EXPECT_NEAR(budget.extreme_bias, 0.0, 1e-5);
  EXPECT_NEAR(budget.u_noise, 0.01, 1e-5);
}

TEST(ExtremeBudget, LinesThatMoveTogetherAreHardlyLargerThanOne) {
  const auto bias = [](int other_unit) {
    return extremeBudget({oneReading(0, 0.1, 0.004, 0.0), oneReading(other_unit, 0.1, 0.004, 0.0)})
        .extreme_bias;
  };
  // The mean of the larger of two normal values is sigma / sqrt(pi) above theirs; two readings of one unit
  // share its place and differ by noise only.
  EXPECT_NEAR(bias(1), std::hypot(0.004, 0.0005) / std::sqrt(std::numbers::pi), 2e-5);
  EXPECT_NEAR(bias(0), 0.0005 / std::sqrt(std::numbers::pi), 2e-5);
}

TEST(ExtremeBudget, ALineThatMovesWithAnotherHardlyRaisesTheLargest) {
  // Each line has a cause of its own, but for two that have one together.
  const auto line = [](Eigen::Index cause, double u_mm) {
    ExtremeLine one = oneReading(0, 0.1, 0.0, 0.0);
    one.points[0].shared = Eigen::RowVectorXd::Zero(ReadingLine::kOwn + 4);
    one.points[0].shared[ReadingLine::kOwn + cause] = u_mm;
    return one;
  };
  const std::vector<ExtremeLine> apart{line(0, 0.004), line(1, 0.004), line(2, 0.002)};
  std::vector<ExtremeLine> more = apart;
  more.push_back(line(2, 0.002));
  const double raised_mm = extremeBudget(more).extreme_bias - extremeBudget(apart).extreme_bias;
  EXPECT_LT(raised_mm, 0.0005 / std::sqrt(std::numbers::pi));
}

TEST(ExtremeBudget, WhatOppositeSidesShareMakesOneOfThemLarger) {
  // The larger of m + e and m - e is m + |e|: half normal.
  constexpr double kShared_mm = 0.004;
  const ExtremeBudget budget =
      extremeBudget({oneReading(0, 0.1, 0.0, kShared_mm), oneReading(1, -0.1, 0.0, kShared_mm)});
  const double u_mm = std::hypot(budget.u_noise, budget.u_camera);
  EXPECT_NEAR(budget.extreme_bias, kShared_mm * std::sqrt(2.0 / std::numbers::pi), 1e-4);
  EXPECT_NEAR(u_mm, std::hypot(kShared_mm * std::sqrt(1.0 - 2.0 / std::numbers::pi), 0.0005), 1e-4);
}

ErrorModel oneLine(std::uint64_t seed, double truth_mm, double noise_mm) {
  constexpr std::size_t kReadings = 200;
  const CounterRandom truth(seed, 1);
  const CounterRandom noise(seed, 2);
  ReadingLine line;
  for (std::size_t i = 0; i < kReadings; ++i) {
    const double true_mm = truth_mm * truth.normal(i);
    line.caliper.push_back(i);
    line.reading_mm.push_back(true_mm + noise_mm * noise.normal(i));
    line.sigma_mm.push_back(noise_mm);
  }
  line.segment = {0, kReadings};
  line.shared = Eigen::MatrixXd::Zero(kReadings, ReadingLine::kOwn);
  ErrorModel model;
  model.lines.push_back(line);
  return model;
}

TEST(WorstDeviation, OfTwoLinesThatCompeteItSaysThatTheCorrectionMayBeWrong) {
  const ErrorModel alone = oneLine(1, 0.01, 0.0005);
  ErrorModel both = alone;
  both.lines.push_back(alone.lines[0]);
  for (double& reading_mm : both.lines[1].reading_mm) reading_mm = -reading_mm;
  for (ReadingLine& line : both.lines) {
    line.shared = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(line.size()), ReadingLine::kOwn + 1);
    line.shared.col(ReadingLine::kOwn).setConstant(0.002);
  }
  both.modes = 1;
  const DeviationEstimate competing = measureDeviations(both, {LineKind{}, LineKind{}}, 0.1, 1).all;
  both.lines.pop_back();
  const DeviationEstimate single = measureDeviations(both, {LineKind{}}, 0.1, 1).all;
  // Half normal against normal: the largest rises by 0.8 sigma.
  EXPECT_NEAR(competing.worst_u_competing, 0.8 * 0.002 / std::sqrt(3.0), 2e-4);
  EXPECT_LT(single.worst_u_competing, 0.5 * competing.worst_u_competing) << "noise alone";
}

TEST(WorstDeviation, OfASingleReadingIsThatReading) {
  ErrorModel model;
  ReadingLine& line = model.lines.emplace_back();
  line.caliper = {0};
  line.reading_mm = {0.03};
  line.sigma_mm = {0.001};
  line.segment = {0, 1};
  line.shared = Eigen::MatrixXd::Zero(1, ReadingLine::kOwn);
  const DeviationEstimate all = measureDeviations(model, {LineKind{}}, 0.1, 1).all;
  EXPECT_NEAR(all.worst.value, 0.03, 2e-4);
  EXPECT_NEAR(all.worst.U, 0.002, 3e-4);
}

TEST(WorstDeviation, RmsIsThatOfTheTruthWithoutItsNoise) {
  constexpr double kTruth_mm = 0.01;
  const DeviationEstimate all = measureDeviations(oneLine(3, kTruth_mm, 0.005), {LineKind{}}, 0.1, 1).all;
  EXPECT_NEAR(all.rms.value, kTruth_mm, 0.1 * kTruth_mm);
}

TEST(WorstDeviation, WhatTheEstimatorLeavesIsPartOfItsU) {
  ErrorModel model = oneLine(1, 0.01, 0.002);
  const double without_U = measureDeviations(model, {LineKind{}}, 0.1, 1).all.worst.U;
  model.estimator_mm = 0.003;
  const double with_U = measureDeviations(model, {LineKind{}}, 0.1, 1).all.worst.U;
  EXPECT_NEAR(with_U, std::hypot(without_U, 0.006), 1e-9);
}

TEST(WorstDeviation, BothIntervalsOfAFlawlessCutEndAtNought) {
  // The reach of the largest noise is known, and subtracted.
  ErrorModel model = oneLine(3, 0.0, 0.002);
  model.estimator_mm = 0.003;
  const UncertaintyBudget b = measureDeviations(model, {LineKind{}}, 0.1, 1).budget;
  EXPECT_NEAR(b.analytic_value - b.analytic_U, 0.0, 1e-12);
  EXPECT_LT(b.analytic_U, 2.0 * std::hypot(0.002, 0.003)) << "U of a single reading, uncut";
  EXPECT_NEAR(b.analytic_U / b.monte_carlo_U, 1.0, 0.2);
}

TEST(WorstDeviation, BudgetFindsTheSameWhereTheTruthHidesMuch) {
  // The truth is as large as the noise: the worst of two hundred places is unknown.
  constexpr int kLines = 20;
  double hidden_mm = 0.0, value_mm = 0.0, ratio = 0.0;
  for (std::uint64_t seed = 1; seed <= kLines; ++seed) {
    const DeviationResult result = measureDeviations(oneLine(seed, 0.004, 0.004), {LineKind{}}, 0.1, seed);
    const UncertaintyBudget& b = result.budget;
    hidden_mm += result.all.worst_hidden / kLines;
    value_mm += (b.analytic_value - b.monte_carlo_value) / kLines;
    ratio += b.analytic_U / b.monte_carlo_U / kLines;
  }
  std::printf("  hidden %.2f um, values differ by %.2f um, U by a factor of %.2f\n", 1e3 * hidden_mm,
              1e3 * value_mm, ratio);
  EXPECT_GT(hidden_mm, 0.001);
  EXPECT_LT(std::abs(value_mm), 0.1 * hidden_mm);
  EXPECT_NEAR(ratio, 1.0, 0.1);
}

TEST(WorstDeviation, WhatALineShowsInTwoTilesCompetes) {
  // One half of the line moves apart from the other, so that one of them is the larger: by 0.56 of the
  // table's error, on average.
  constexpr double kTable_mm = 0.004;
  ErrorModel model = oneLine(2, 0.0, 0.0002);
  ReadingLine& line = model.lines[0];
  model.tiles = model.modes = 4;
  line.tiles = {0, 1, 2, 3};
  line.shared = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(line.size()), ReadingLine::kOwn + 4);
  for (std::size_t i = 0; i < line.size(); ++i) {
    line.reading_mm[i] += 0.1;
    line.tile.push_back(i < line.size() / 2 ? 0 : 1);
    line.shared(static_cast<Eigen::Index>(i), ReadingLine::kOwn + 2 * line.tile[i]) = kTable_mm;
  }
  const UncertaintyBudget b = measureDeviations(model, {LineKind{}}, 0.2, 1).budget;
  EXPECT_NEAR(b.entries.at(kByNoise).correction, kTable_mm / std::sqrt(std::numbers::pi), 0.1 * kTable_mm);
  EXPECT_NEAR(b.analytic_value, b.monte_carlo_value, 0.1 * kTable_mm);
}

TEST(WorstDeviation, NothingIsHiddenWhereNoiseExplainsAllThatIsSeen) {
  // In about half of all flawless cuts the estimates scatter no more than their noise: the likely truth has
  // none left.
  constexpr int kCuts = 20;
  int nothing_hidden = 0;
  for (std::uint64_t seed = 1; seed <= kCuts; ++seed) {
    const DeviationEstimate all = measureDeviations(oneLine(seed, 0.0, 0.002), {LineKind{}}, 0.1, 1).all;
    if (all.worst_hidden == 0.0) ++nothing_hidden;
  }
  EXPECT_GE(nothing_hidden, kCuts / 4);
}

/// Frames of a cut whose spot drifts evenly from one end to the other.
ErrorModel aTrend(std::uint64_t seed, double reach_mm, double noise_mm) {
  constexpr std::size_t kFrames = 40;
  ErrorModel model;
  model.trends = true;
  ReadingLine& line = model.lines.emplace_back();
  const CounterRandom noise(seed, 1);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double share = 2.0 * static_cast<double>(i) / (kFrames - 1.0) - 1.0;
    line.reading_mm.push_back(reach_mm * share + noise_mm * noise.normal(i));
    line.sigma_mm.push_back(noise_mm);
  }
  line.segment = {0, kFrames};
  line.shared = Eigen::MatrixXd::Zero(kFrames, ReadingLine::kOwn);
  return model;
}

TEST(WorstDeviation, OfATrendIsKnownBetterThanAnyOfItsPlaces) {
  constexpr double kReach_mm = 0.01;
  constexpr double kNoise_mm = 0.0015;
  constexpr std::uint64_t kTrials = 300;
  int within = 0;
  double sum_of_U_mm = 0.0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const ErrorModel model = aTrend(trial, kReach_mm, kNoise_mm);
    const DeviationEstimate all = measureDeviations(model, {LineKind{}}, 0.1, trial).all;
    within += std::abs(all.worst.value - kReach_mm) <= all.worst.U ? 1 : 0;
    sum_of_U_mm += all.worst.U;
  }
  const double cover = within / static_cast<double>(kTrials);
  std::printf("  cover %.1f %%, U %.2f um\n", 1e2 * cover, 1e3 * sum_of_U_mm / kTrials);
  EXPECT_GT(cover, 0.92);
  EXPECT_LT(sum_of_U_mm / kTrials, 2.0 * kNoise_mm);
  ErrorModel places = aTrend(1, kReach_mm, kNoise_mm);
  places.trends = false;
  EXPECT_GE(measureDeviations(places, {LineKind{}}, 0.1, 1).all.worst.U, 2.0 * kNoise_mm)
      << "where it is not known how many places compete";
}

}  // namespace
}  // namespace kerfbench::inspect

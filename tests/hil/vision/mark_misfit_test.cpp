// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_misfit.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::vision {
namespace {

constexpr double kSigma_mm = 0.002;
const std::vector<Eigen::Vector2d> kFive{{-55, -27}, {-55, 27}, {-5, -27}, {-5, 27}, {-20, 27}};

/// Marks as seen on a sheet that lies somewhere and askew, each with an error of its own.
std::vector<MarkPair> seen(std::mt19937& random, std::size_t count, double sigma_mm) {
  std::normal_distribution<double> error(0.0, sigma_mm);
  PlaneMotion motion;
  motion.shift_mm = {120.0, -40.0};
  motion.angle_rad = 0.02;
  std::vector<MarkPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d off_mm(error(random), error(random));
    pairs.push_back({kFive[i], motion * kFive[i] + off_mm, kSigma_mm});
  }
  return pairs;
}

TEST(MarkMisfit, GoodSheetsAreAccusedAsRarelyAsTheChanceSays) {
  constexpr int kSheets = 20000;
  constexpr double kChance = 0.01;
  std::mt19937 random(11);
  for (const std::size_t count : {2U, 3U, 4U, 5U}) {
    int accused = 0;
    for (int i = 0; i < kSheets; ++i) accused += worstMisfit(seen(random, count, kSigma_mm), kChance) ? 1 : 0;
    // Bonferroni's bound is an upper one: 200 accused at most, and 3.1 standard deviations of chance. It is
    // near to what happens, so that the check is not blunt either.
    EXPECT_LT(accused, kSheets * kChance + 3.1 * std::sqrt(kSheets * kChance)) << count << " marks";
    EXPECT_GT(accused, 0.25 * kSheets * kChance) << count << " marks";
  }
}

TEST(MarkMisfit, OfFiveTheMarkThatMovedIsNamedWithHowFar) {
  std::mt19937 random(12);
  for (std::size_t moved = 0; moved < kFive.size(); ++moved) {
    for (const Eigen::Vector2d& by_mm : {Eigen::Vector2d(0.3, 0.0), Eigen::Vector2d(-0.02, 0.03)}) {
      std::vector<MarkPair> pairs = seen(random, 5, kSigma_mm);
      pairs[moved].q_mm += by_mm;
      const auto misfit = worstMisfit(pairs, 5e-4);
      ASSERT_TRUE(misfit) << moved;
      EXPECT_EQ(misfit->pair, moved);
      EXPECT_NEAR(misfit->off_mm, by_mm.norm(), 6.0 * kSigma_mm);
      EXPECT_LT(misfit->most_mm, misfit->off_mm);
    }
  }
}

TEST(MarkMisfit, WhatTheUncertaintyAllowsIsNoMisfit) {
  std::mt19937 random(13);
  std::vector<MarkPair> pairs = seen(random, 5, 0.0);
  pairs[2].q_mm.x() += 2.0 * kSigma_mm;
  EXPECT_FALSE(worstMisfit(pairs, 5e-4));
  pairs[2].q_mm.x() += 10.0 * kSigma_mm;
  EXPECT_TRUE(worstMisfit(pairs, 5e-4));
  for (MarkPair& pair : pairs) pair.sigma_mm *= 10.0;
  EXPECT_FALSE(worstMisfit(pairs, 5e-4)) << "a print that is ten times as rough";
}

TEST(MarkMisfit, TwoMarksTellByTheirDistanceAlone) {
  std::mt19937 random(14);
  std::vector<MarkPair> pairs = seen(random, 2, 0.0);
  const Eigen::Vector2d along = (pairs[1].q_mm - pairs[0].q_mm).normalized();
  pairs[1].q_mm += 0.05 * Eigen::Vector2d(-along.y(), along.x());
  EXPECT_FALSE(worstMisfit(pairs, 5e-4)) << "the sheet may lie at that angle";
  pairs[1].q_mm += 0.05 * along;
  ASSERT_TRUE(worstMisfit(pairs, 5e-4));
  EXPECT_NEAR(worstMisfit(pairs, 5e-4)->off_mm, 0.05, 1e-4);
}

TEST(MarkMisfit, RefusesWhatItCannotJudge) {
  std::mt19937 random(15);
  std::vector<MarkPair> pairs = seen(random, 5, 0.0);
  EXPECT_THROW((void)worstMisfit(std::span(pairs).first(1), 1e-3), std::invalid_argument);
  EXPECT_THROW((void)worstMisfit(pairs, 0.0), std::invalid_argument);
  EXPECT_THROW((void)worstMisfit(pairs, 1.0), std::invalid_argument);
  pairs[3].sigma_mm = 0.0;
  EXPECT_THROW((void)worstMisfit(pairs, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::vision

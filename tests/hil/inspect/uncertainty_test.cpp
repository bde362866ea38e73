// SPDX-License-Identifier: Apache-2.0
// Intervals, chances and the statements of risk, compared with values whose distribution is known.
#include "hil/inspect/verdict/uncertainty.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/inspect/verdict/verdict.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

using ::testing::HasSubstr;

// Value from the table of the normal distribution.
constexpr double kBeyondOneSigma = 0.15866;

std::vector<double> normals(std::uint64_t stream, std::size_t count, double mean, double sigma) {
  const CounterRandom random(5, stream);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(mean + sigma * random.normal(i));
  return out;
}

TEST(BasicInterval, HoldsTheTruthThoughReadingsAreSkewedAndTooLarge) {
  // A reading exceeds the truth by an exponential value of mean 1, as a maximum of noisy readings does.
  constexpr double kTruth = 7.0;
  const auto reading = [&](std::uint64_t stream, std::uint64_t i) {
    return kTruth - std::log(1.0 - CounterRandom(6, stream).uniform(i));
  };
  std::vector<double> simulated;
  for (std::uint64_t i = 0; i < 4000; ++i) simulated.push_back(reading(1, i));
  constexpr int kRuns = 2000;
  int inside = 0;
  for (std::uint64_t i = 0; i < kRuns; ++i) {
    const Quantity q = basicInterval(reading(2, i), kTruth, simulated);
    inside += std::abs(kTruth - q.value) <= q.U ? 1 : 0;
  }
  // Chance contributes 1.4 %, at three standard deviations.
  EXPECT_NEAR(static_cast<double>(inside) / kRuns, 0.9545, 0.014);
}

TEST(BasicInterval, NeverReachesWhereNoTruthCanBe) {
  const Quantity q = basicInterval(0.3, 0.3, normals(3, 500, 0.3, 1.0), 0.0);
  EXPECT_GE(q.value - q.U, -1e-12);
  EXPECT_GT(q.value + q.U, 1.5);
}

TEST(BasicInterval, WithoutFiniteSimulationsSaysNothing) {
  EXPECT_TRUE(std::isnan(basicInterval(1.0, 1.0, {}).U));
  EXPECT_TRUE(std::isnan(basicInterval(1.0, 1.0, {1.0, std::nan("")}).U));
}

TEST(Chance, OfANormalTruthIsThatOfTheTable) {
  const Quantity q{10.0, 2.0};  // One standard uncertainty is half of U.
  EXPECT_NEAR(chanceAboveNormal(11.0, q), kBeyondOneSigma, 1e-5);
  EXPECT_NEAR(chanceAboveNormal(9.0, q), 1.0 - kBeyondOneSigma, 1e-5);
  EXPECT_NEAR(chanceAboveNormal(10.0, q), 0.5, 1e-12);
}

TEST(Chance, OfSimulationsAgreesWithTheNormalThatTheyWereDrawnFrom) {
  constexpr double kBias = 0.7;
  const std::vector<double> simulated = normals(4, 3000, 4.0 + kBias, 0.5);
  for (const double off : {-1.0, -0.5, 0.0, 0.25, 0.5, 1.0}) {
    const double by_table = chanceAboveNormal(4.0 + off, {4.0, 1.0});
    EXPECT_NEAR(chanceAbove(4.0 + off, 4.0 + kBias, 4.0, simulated), by_table, 0.03) << off;
  }
}

TEST(Chance, OfFewSimulationsIsThatOfTheirKernels) {
  // Sixteen draws, each spread by Silverman's kernel of 1.06 sigma n^-1/5 and drawn in; made with another
  // program.
  const std::vector<double> simulated{-2.0, -1.5, -1.2, -0.7, -0.4, -0.1, 0.0, 0.2,
                                      0.3,  0.5,  0.8,  0.9,  1.1,  1.6,  2.2, 3.0};
  EXPECT_NEAR(chanceAbove(4.0, 5.0, 0.25, simulated), 0.774126, 1e-5);
  EXPECT_NEAR(chanceAbove(7.0, 5.0, 0.25, simulated), 0.053608, 1e-5);
  EXPECT_NEAR(chanceAbove(8.0, 5.0, 0.25, simulated), 0.005619, 1e-5);
}

/// A reading one standard uncertainty off its limit, on one side or the other.
Check nearLimit(bool upper, double off) {
  Check check;
  check.unit = "mm";
  check.upper = upper;
  check.limit = 5.0;
  check.value = 5.0 + off;
  check.u = 2.0;
  check.guard = 0.1;
  decide(check);
  return check;
}

TEST(Risk, IsTheChanceThatTheVerdictIsWrong) {
  for (const bool upper : {true, false}) {
    SCOPED_TRACE(upper ? "upper limit" : "lower limit");
    Check good = nearLimit(upper, upper ? -1.0 : 1.0);
    ASSERT_EQ(good.verdict, Verdict::kPass);
    EXPECT_THAT(riskSentence(good), HasSubstr("in truth beyond 5 mm is 16 %"));
    EXPECT_NEAR(good.chance_beyond, kBeyondOneSigma, 1e-4);
    Check bad = nearLimit(upper, upper ? 1.0 : -1.0);
    ASSERT_EQ(bad.verdict, Verdict::kFail);
    EXPECT_THAT(riskSentence(bad), HasSubstr("in truth within 5 mm is 16 %"));
    EXPECT_NEAR(bad.chance_beyond, 1.0 - kBeyondOneSigma, 1e-4);
  }
}

TEST(Risk, IsNotToldOfCountsAndOfWhatWasNotMeasured) {
  Check counted = nearLimit(true, -1.0);
  counted.guard = 0.0;
  EXPECT_TRUE(riskSentence(counted).empty());
  Check broken = nearLimit(true, std::nan(""));
  EXPECT_TRUE(riskSentence(broken).empty());
}

}  // namespace
}  // namespace kerfbench::inspect

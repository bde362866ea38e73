// SPDX-License-Identifier: Apache-2.0
#include "hil/gauge/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "twin/base/random.h"

namespace kerfbench::gauge {
namespace {

std::vector<double> normals(std::size_t count, std::uint64_t stream) {
  const CounterRandom random(42, stream);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(random.normal(i));
  return values;
}

TEST(ClopperPearson, AgreesWithPublishedTables) {
  // Values of tables for 95 %: 0 of 10, 5 of 10, 10 of 10; 950 of 1000.
  EXPECT_NEAR(clopperPearson(0, 10).low, 0.0, 1e-12);
  EXPECT_NEAR(clopperPearson(0, 10).high, 0.3085, 5e-5);
  EXPECT_NEAR(clopperPearson(5, 10).low, 0.1871, 5e-5);
  EXPECT_NEAR(clopperPearson(5, 10).high, 0.8129, 5e-5);
  EXPECT_NEAR(clopperPearson(10, 10).low, 0.6915, 5e-5);
  EXPECT_NEAR(clopperPearson(10, 10).high, 1.0, 1e-12);
  EXPECT_NEAR(clopperPearson(950, 1000).low, 0.9346, 5e-5);
  EXPECT_NEAR(clopperPearson(950, 1000).high, 0.9627, 5e-5);
}

TEST(ClopperPearson, OfNoHitsIsTheRuleOfThree) {
  // The rate after 3000 bad cuts without a PASS: with 97.5 % fewer than 1.23 in a thousand.
  EXPECT_NEAR(clopperPearson(0, 3000).high, 1.0 - std::pow(0.025, 1.0 / 3000.0), 1e-9);
}

TEST(ClopperPearson, IsMirrored) {
  const Interval a = clopperPearson(37, 400);
  const Interval b = clopperPearson(363, 400);
  EXPECT_NEAR(a.low, 1.0 - b.high, 1e-9);
  EXPECT_NEAR(a.high, 1.0 - b.low, 1e-9);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantileOf({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantileOf({4.0, 1.0, 3.0, 2.0}, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantileOf({4.0, 1.0, 3.0, 2.0}, 1.0), 4.0);
  EXPECT_TRUE(std::isnan(quantileOf({}, 0.5)));
}

TEST(ToleranceBound, NeedsFiftyNineValuesFor95With95) {
  std::vector<double> values(58, 1.0);
  EXPECT_FALSE(upperToleranceBound(values));
  values.push_back(2.0);
  ASSERT_TRUE(upperToleranceBound(values));
  EXPECT_DOUBLE_EQ(*upperToleranceBound(values), 2.0);
}

TEST(ToleranceBound, LiesAboveTheQuantileAsOftenAsItSays) {
  const double quantile = 1.644854;
  int above = 0;
  for (std::uint64_t s = 0; s < 1000; ++s) above += *upperToleranceBound(normals(93, s)) >= quantile ? 1 : 0;
  // At n = 93 the confidence is 95.0 % exactly enough (second largest value).
  EXPECT_GE(above, 935);
  EXPECT_LE(above, 975);
}

TEST(TypeOneStudy, FollowsIso22514Part7) {
  // s = 1, bias = 2, T = 100: Cg = 20 / 6, Cgk = (10 - 2) / 3.
  const TypeOne t = typeOne({1.0, 2.0, 3.0}, 100.0);
  EXPECT_DOUBLE_EQ(t.error.mean, 2.0);
  EXPECT_DOUBLE_EQ(t.error.sigma, 1.0);
  EXPECT_DOUBLE_EQ(t.cg, 20.0 / 6.0);
  EXPECT_DOUBLE_EQ(t.cgk, 8.0 / 3.0);
}

TEST(TypeOneStudy, ABiasBeyondATenthOfTheToleranceIsNegative) {
  EXPECT_LT(typeOne({11.0, 11.5, 12.0}, 100.0).cgk, 0.0);
  EXPECT_GT(typeOne({-9.0, -9.5, -9.2}, 100.0).cgk, 0.0);
}

/// Values part + place + both + noise with the given standard deviations.
std::vector<double> grrValues(std::size_t p, std::size_t o, std::size_t r, double part, double place,
                              double noise) {
  const CounterRandom random(7, 3);
  std::vector<double> values;
  for (std::size_t i = 0; i < p * o * r; ++i) {
    const std::size_t cell = i / r;
    values.push_back(part * random.normal(cell / o) + place * random.normal(1000 + cell % o) +
                     noise * random.normal(100000 + i));
  }
  return values;
}

TEST(GrrStudy, FindsTheStandardDeviationsThatWerePutIn) {
  const Grr g = anovaGrr(grrValues(400, 200, 3, 5.0, 0.5, 0.2), 400, 200, 3, 10.0);
  EXPECT_NEAR(g.repeatability, 0.2, 0.005);
  EXPECT_NEAR(g.reproducibility, 0.5, 0.05);
  EXPECT_NEAR(g.part, 5.0, 0.4);
  EXPECT_NEAR(g.grr, std::hypot(g.repeatability, g.reproducibility), 1e-12);
  EXPECT_NEAR(g.percent_of_tolerance, 60.0 * g.grr, 1e-9);
  EXPECT_NEAR(g.ndc, 1.41 * g.part / g.grr, 1e-9);
}

TEST(GrrStudy, AgreesWithAnalysisOfVarianceByHand) {
  // The sample has two parts, two placements, two repeats: means of the cells 2, 5 and 12, 11; sums of
  // squares by hand.
  const std::vector<double> v{1.0, 3.0, 4.0, 6.0, 11.0, 13.0, 10.0, 12.0};
  const Grr g = anovaGrr(v, 2, 2, 2, 100.0);
  EXPECT_NEAR(g.repeatability, std::sqrt(2.0), 1e-12);
  // MS: part 128, placement 2, interaction 8, repeats 2.
  EXPECT_NEAR(g.reproducibility, std::sqrt(0.0 + (8.0 - 2.0) / 2.0), 1e-12);
  EXPECT_NEAR(g.part, std::sqrt((128.0 - 8.0) / 4.0), 1e-12);
}

TEST(GrrStudy, RefusesAnIncompleteTable) {
  EXPECT_THROW(anovaGrr({1.0, 2.0, 3.0}, 2, 2, 2, 1.0), std::invalid_argument);
  EXPECT_THROW(anovaGrr({1.0, 2.0}, 1, 1, 2, 1.0), std::invalid_argument);
}

TEST(LinearityStudy, FindsOffsetAndSlope) {
  std::vector<double> truth;
  std::vector<double> error;
  const std::vector<double> noise = normals(2000, 5);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    truth.push_back(0.05 * static_cast<double>(i));
    error.push_back(0.3 - 0.02 * truth.back() + 0.1 * noise[i]);
  }
  const Linearity l = linearityOf(truth, error);
  EXPECT_NEAR(l.offset, 0.3, 0.02);
  EXPECT_NEAR(l.slope, -0.02, 4.0 * l.slope_sigma);
  EXPECT_NEAR(l.scatter, 0.1, 0.005);
}

}  // namespace
}  // namespace kerfbench::gauge

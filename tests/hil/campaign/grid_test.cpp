// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/grid.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::campaign {
namespace {

Factor listed(const std::string& name, const std::vector<std::string>& values) {
  return {name, false, {{"", Values{.list = values}, {{.key = "k." + name, .text = kValueHolder}}}}};
}
Factor drawn(const std::string& name, const Values& values) {
  return {name, false, {{"", values, {{.key = "k." + name, .text = kValueHolder}}}}};
}
Factor faults() {
  return {"fault",
          true,
          {{"none", std::nullopt, {}},
           {"a", Values{.list = {"1", "2"}}, {{.key = "a", .text = kSizeHolder}}},
           {"b",
            Values{.kind = Values::Kind::kLogUniform, .min = 0.01, .max = 100},
            {{.key = "b", .text = kSizeHolder}}}}};
}

Campaign plain() {
  Campaign c;
  c.name = "c";
  c.bases = {"/x/one.yaml", "/x/two.yaml"};
  c.factors = {listed("speed", {"10", "20", "30"}), faults()};
  return c;
}

double numberOf(const Campaign& c, std::size_t run, std::size_t factor = 0) {
  return std::stod(planOf(c, run).factors[factor].value);
}

TEST(CampaignGrid, EveryPointComesOnceTheLastFactorFirst) {
  const Campaign c = plain();
  ASSERT_EQ(c.runs(), 2U * 3U * 4U);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < c.runs(); ++i) {
    const RunPlan plan = planOf(c, i);
    std::string key = std::to_string(plan.base);
    for (const FactorValue& f : plan.factors) key += "," + f.value;
    // A drawn size makes no point of its own.
    if (plan.factors[1].value == "a") key += ":" + std::to_string(*plan.factors[1].size);
    EXPECT_TRUE(seen.insert(key).second) << key;
  }
  EXPECT_EQ(planOf(c, 0).factors[1].value, "none");
  EXPECT_EQ(planOf(c, 1).factors[1].size, 1.0);
  EXPECT_EQ(planOf(c, 2).factors[1].size, 2.0);
  EXPECT_EQ(planOf(c, 3).factors[1].value, "b");
  EXPECT_EQ(planOf(c, 4).factors[0].value, "20");
  EXPECT_EQ(planOf(c, 12).base, 1U);
}

TEST(CampaignGrid, RepeatsOfAPointDifferBySeedAndByWhatIsDrawn) {
  Campaign c = plain();
  c.repeats = 3;
  ASSERT_EQ(c.runs(), 72U);
  const RunPlan first = planOf(c, 9), second = planOf(c, 10);
  EXPECT_EQ(first.factors[1].value, "b");
  EXPECT_EQ(second.factors[1].value, "b");
  EXPECT_NE(first.factors[1].size, second.factors[1].size);
  EXPECT_NE(first.seed, second.seed);
}

TEST(CampaignGrid, ARunDependsOnFileAndIndexAlone) {
  Campaign c = plain();
  c.draws = 200;
  std::vector<RunPlan> forward;
  for (std::size_t i = 0; i < c.draws; ++i) forward.push_back(planOf(c, i));
  for (std::size_t i = c.draws; i-- > 0;) EXPECT_EQ(planOf(c, i), forward[i]);
  c.draws = 1000;  // More runs leave the first as they are.
  for (std::size_t i = 0; i < forward.size(); ++i) EXPECT_EQ(planOf(c, i), forward[i]);
  c.seed = 2;
  EXPECT_NE(planOf(c, 5), forward[5]);
}

TEST(CampaignGrid, AnotherFactorChangesNoValueOfTheOthers) {
  Campaign c = plain();
  c.draws = 50;
  Campaign more = c;
  more.factors.insert(more.factors.begin(),
                      drawn("new", {.kind = Values::Kind::kUniform, .min = 0, .max = 1}));
  for (std::size_t i = 0; i < c.draws; ++i) {
    EXPECT_EQ(planOf(more, i).factors[1], planOf(c, i).factors[0]);
    EXPECT_EQ(planOf(more, i).factors[2], planOf(c, i).factors[1]);
    EXPECT_EQ(planOf(more, i).seed, planOf(c, i).seed);
  }
}

TEST(CampaignGrid, DrawnValuesHaveTheirDistribution) {
  constexpr std::size_t kDraws = 20'000;
  Campaign c;
  c.bases = {"/x/one.yaml"};
  c.draws = kDraws;
  c.factors = {drawn("u", {.kind = Values::Kind::kUniform, .min = 2, .max = 4}),
               drawn("l", {.kind = Values::Kind::kLogUniform, .min = 0.01, .max = 100}),
               drawn("n", {.kind = Values::Kind::kNormal, .min = -1, .max = 3, .mean = 1, .sigma = 1})};
  double u = 0, l = 0, n = 0, n2 = 0;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const double uu = numberOf(c, i, 0), ll = numberOf(c, i, 1), nn = numberOf(c, i, 2);
    EXPECT_TRUE(uu >= 2 && uu <= 4 && ll >= 0.01 && ll <= 100 && nn >= -1 && nn <= 3);
    u += uu / kDraws;
    l += std::log(ll) / kDraws;
    n += nn / kDraws;
    n2 += (nn - 1) * (nn - 1) / kDraws;
  }
  // Standard deviations of these means: 0.0041, 0.0188, 0.0063; the bounds are five of them.
  EXPECT_NEAR(u, 3.0, 0.021);
  EXPECT_NEAR(l, 0.0, 0.095);
  EXPECT_NEAR(n, 1.0, 0.032);
  // Variance of a normal that is cut off at two sigma: 1 - 4 phi(2) / (2 Phi(2) - 1) = 0.7737.
  EXPECT_NEAR(n2, 0.7737, 0.03);
}

TEST(CampaignGrid, FactorsAreDrawnIndependently) {
  constexpr std::size_t kDraws = 12'000;
  Campaign c = plain();
  c.draws = kDraws;
  std::map<std::pair<std::string, std::string>, double> cells;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const RunPlan plan = planOf(c, i);
    cells[{std::to_string(plan.base) + plan.factors[0].value, plan.factors[1].value}] += 1.0;
  }
  ASSERT_EQ(cells.size(), 18U);
  double chi_squared = 0.0;
  for (const auto& [key, count] : cells) chi_squared += std::pow(count - kDraws / 18.0, 2) / (kDraws / 18.0);
  EXPECT_LT(chi_squared, 40.8);  // 99.9 % quantile for 17 degrees of freedom.
}

TEST(CampaignGrid, SeedsAreOnesThatPeopleCanTypeAndMayBeTheFiles) {
  Campaign c = plain();
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < c.runs(); ++i) seeds.insert(*planOf(c, i).seed);
  EXPECT_EQ(seeds.size(), c.runs());
  EXPECT_LT(*seeds.rbegin(), 1'000'000'000U);
  c.own_seeds = false;
  EXPECT_FALSE(planOf(c, 0).seed);
}

TEST(CampaignGrid, ShardsPartTheRuns) {
  for (const std::size_t shards : {1U, 3U, 7U, 20U}) {
    std::set<std::size_t> seen;
    for (std::size_t s = 1; s <= shards; ++s)
      for (const std::size_t run : indicesOf(17, s, shards)) EXPECT_TRUE(seen.insert(run).second);
    EXPECT_EQ(seen.size(), 17U);
  }
}

}  // namespace
}  // namespace kerfbench::campaign

// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/verdict/verdict.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hil/inspect/evidence/extreme.h"
#include "tests/hil/inspect/not_numbers.h"

namespace kerfbench::inspect {
namespace {

Check makeCheck(double value, double limit, double guard, bool upper = true) {
  Check check;
  check.value = value;
  check.limit = limit;
  check.guard = check.u = guard;
  check.upper = upper;
  return check;
}

TEST(DecisionRule, FollowsTheTable) {
  struct Row {
    double value, limit, guard;
    bool upper;
    Verdict expected;
  };
  const Row rows[] = {
      {0.030, 0.05, 0.01, true, Verdict::kPass},       {0.0399, 0.05, 0.01, true, Verdict::kPass},
      {0.0401, 0.05, 0.01, true, Verdict::kNotProven}, {0.050, 0.05, 0.01, true, Verdict::kNotProven},
      {0.0599, 0.05, 0.01, true, Verdict::kNotProven}, {0.0601, 0.05, 0.01, true, Verdict::kFail},
      {1.000, 0.99, 0.00, false, Verdict::kPass},      {0.990, 0.99, 0.00, false, Verdict::kPass},
      {0.989, 0.99, 0.00, false, Verdict::kFail},      {0.0, 0.0, 0.0, true, Verdict::kPass},
      {1.0, 0.0, 0.0, true, Verdict::kFail},           {2.0, 1.0, 0.5, false, Verdict::kPass},
      {1.2, 1.0, 0.5, false, Verdict::kNotProven},     {0.4, 1.0, 0.5, false, Verdict::kFail},
      {kNan, 0.05, 0.01, true, Verdict::kInvalid},     {0.01, kNan, 0.01, true, Verdict::kInvalid},
      {0.01, 0.05, kNan, true, Verdict::kInvalid},     {kInf, 0.05, 0.01, true, Verdict::kInvalid},
      {-kInf, 0.05, 0.01, true, Verdict::kInvalid},    {0.01, 0.05, -0.01, true, Verdict::kInvalid},
  };
  for (const Row& row : rows) {
    Check check = makeCheck(row.value, row.limit, row.guard, row.upper);
    EXPECT_EQ(decide(check), row.expected) << row.value << " against " << row.limit << " ± " << row.guard;
    EXPECT_EQ(check.verdict, row.expected);
  }
}

TEST(DecisionRule, AnUnstatedUncertaintyIsNotZero) {
  Check check = makeCheck(0.01, 0.05, 0.0);
  check.u = kNan;
  EXPECT_EQ(decide(check), Verdict::kInvalid);
}

TEST(CombineVerdicts, TheGravestWins) {
  const auto of = [](std::initializer_list<Verdict> verdicts) {
    std::vector<Check> checks;
    for (const Verdict v : verdicts) checks.emplace_back().verdict = v;
    return checks;
  };
  using enum Verdict;
  EXPECT_EQ(combine(of({kPass, kPass}), true), kPass);
  EXPECT_EQ(combine(of({kPass, kNotProven}), true), kNotProven);
  EXPECT_EQ(combine(of({kNotProven, kFail, kPass}), true), kFail);
  EXPECT_EQ(combine(of({kFail, kInvalid}), true), kFail) << "a proven fault stays one";
  EXPECT_EQ(combine(of({kNotProven, kInvalid}), true), kInvalid);
  EXPECT_EQ(combine(of({kFail}), false), kInvalid);
  EXPECT_EQ(combine(of({kPass}), false), kInvalid);
  EXPECT_EQ(combine({}, true), kInvalid) << "nothing is PASS by default";
}

TEST(VerdictNames, GoWithTheirExitCodes) {
  EXPECT_EQ(exitCode(Verdict::kPass), 0);
  EXPECT_EQ(exitCode(Verdict::kFail), 1);
  EXPECT_EQ(exitCode(Verdict::kInvalid), 3);
  EXPECT_EQ(exitCode(Verdict::kNotProven), 4);
  EXPECT_EQ(verdictName(Verdict::kNotProven), "NOT PROVEN");
  EXPECT_EQ(Check{}.verdict, Verdict::kInvalid);
}

TEST(ExtremeEstimate, OneReadingIsItselfWithTwoSigma) {
  ExtremeEstimate one(1);
  one.add(-0.03, 0.002);
  EXPECT_NEAR(one.value(), 0.03, 1e-12);
  EXPECT_NEAR(one.expandedU(), 0.004, 1e-12);
}

TEST(ExtremeEstimate, IntervalHoldsTheTrueWorstInNineteenOfTwenty) {
  // The sample has 1000 places, most truly at 0, some at up to 0.02; noise 0.005: the raw maximum alone would
  // be off by 3 sigma.
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.005);
  for (const double true_worst : {0.0, 0.02, 0.05}) {
    int inside = 0;
    constexpr int kRuns = 1000;
    for (int run = 0; run < kRuns; ++run) {
      ExtremeEstimate estimate(1000);
      for (int i = 0; i < 1000; ++i) estimate.add((i == 500 ? true_worst : 0.0) + noise(random), 0.005);
      inside += std::abs(estimate.value() - true_worst) <= estimate.expandedU() ? 1 : 0;
    }
    EXPECT_GE(inside, kRuns * 945 / 1000) << true_worst;
  }
}

TEST(ExtremeEstimate, AnUnknownUncertaintyDoesNotGetLost) {
  ExtremeEstimate estimate(3);
  estimate.add(0.01, 0.001);
  estimate.add(0.01, kNan);
  estimate.add(0.01, 0.001);
  EXPECT_TRUE(std::isnan(estimate.value()));
}

TEST(ExtremeQuantile, GrowsWithTheCountAsTablesSay) {
  EXPECT_NEAR(extremeQuantile(1), 2.0, 1e-9);
  EXPECT_NEAR(extremeQuantile(10000), 4.58, 0.03);  // 1 - 0.9545^(1/10000) = 4.66e-6, two-sided.
}

}  // namespace
}  // namespace kerfbench::inspect

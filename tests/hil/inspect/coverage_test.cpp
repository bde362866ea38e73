// SPDX-License-Identifier: Apache-2.0
// Stated intervals compared with the truth, on evidence sampled from the error model; 1000 cases by
// inspect_coverage.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/hil/inspect/drawn_evidence.h"

namespace kerfbench::inspect {
namespace {

using testing::Coverage;

void expectHonestIntervals(int cases) {
  const Coverage c = testing::measureCoverage(1, cases);
  // The requirement is 94 to 96.8 %; by chance the cases may show 3.1 standard deviations less, one time in a
  // thousand.
  const double least = 0.94 - 3.1 * std::sqrt(0.94 * 0.06 / cases);
  EXPECT_GE(c.worst.share(), least);
  EXPECT_GE(c.entity_worst.share(), least);
  EXPECT_GE(c.worst_drift.share(), least);
  EXPECT_GE(c.rms.share(), least);
  EXPECT_GE(c.width.share(), least);
  EXPECT_GE(c.drift.share(), least);
  EXPECT_GT(c.bad, cases / 5);
  EXPECT_GT(c.good, cases / 5);
  EXPECT_EQ(c.wrong_pass, 0);
  EXPECT_EQ(c.wrong_fail, 0);
  EXPECT_LE(c.largest_U_mm, 0.005);
  EXPECT_NEAR(c.budget_ratio[c.budget_ratio.size() / 2], 1.0, 0.1);
}

TEST(DrawnEvidence, IntervalsHoldTheTruthAndVerdictsAreNeverWrong) { expectHonestIntervals(20); }
TEST(DrawnEvidenceLong, IntervalsHoldTheTruthAndVerdictsAreNeverWrong) { expectHonestIntervals(150); }

}  // namespace
}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
// Pictures compared with the belt's encoder.
#include <algorithm>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using ::testing::HasSubstr;

/// Travel of the belt from the first frame of a cut to the last, at 200 mm/s; of the longest cut.
double longestTravelMm(const InspectionResult& result) {
  double longest_s = 0.0;
  for (const CutResult& cut : result.cuts) longest_s = std::max(longest_s, cut.end_s - cut.start_s);
  return 200.0 * longest_s;
}

SyntheticRun withBeltScaled(double by) {
  SyntheticRun run;
  for (BeltEdge& edge : run.evidence.belt) edge.x_mm *= 1.0 + by;
  return run;
}

TEST(Belt, TwoWitnessesOfOneMotionAgree) {
  const auto result = SyntheticRun().inspected();
  const Check& check = checkOf(result, "belt");
  EXPECT_EQ(check.verdict, Verdict::kPass);
  EXPECT_LE(check.value, check.u);
  EXPECT_GT(check.u, 0.004) << "both ends lie between two counts of 0.01 mm; the interval begins at nought";
  EXPECT_LT(check.u, 0.01);
}

TEST(Belt, AnEncoderThatCountsTooFewIsTold) {
  const auto result = withBeltScaled(-0.005).inspected();
  const Check& check = checkOf(result, "belt");
  EXPECT_EQ(check.verdict, Verdict::kInvalid);
  EXPECT_NEAR(check.value, 0.005 * longestTravelMm(result), check.u);
  EXPECT_THAT(check.explanation, HasSubstr("mm more than the encoder's"));
  EXPECT_THAT(check.explanation, HasSubstr("+0.50"));
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
}

TEST(Belt, OneThatCountsTooManyHasTheOtherSign) {
  EXPECT_THAT(checkOf(withBeltScaled(0.005).inspected(), "belt").explanation, HasSubstr("-0.497"));
}

TEST(Belt, LessThanTheLimitOfStillnessIsNoContradiction) {
  const auto result = withBeltScaled(0.0002).inspected();
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_NEAR(checkOf(result, "belt").value, 0.0002 * longestTravelMm(result), checkOf(result, "belt").u);
}

TEST(Belt, ASlipWithinACutIsSeen) {
  SyntheticRun run;
  // The belt jumps by a tenth of a millimetre in the middle of the second unit's crease.
  double middle_s = 0.0;
  for (const CutResult& cut : run.inspected().cuts) {
    if (cut.unit == 1 && cut.entity == kCreaseLine) middle_s = 0.5 * (cut.start_s + cut.end_s);
  }
  ASSERT_GT(middle_s, 0.0);
  for (BeltEdge& edge : run.evidence.belt) edge.x_mm += edge.time_s > middle_s ? 0.1 : 0.0;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "belt").verdict, Verdict::kInvalid);
  EXPECT_EQ(checkOf(result, "belt").subject, "unit 1");
}

TEST(Belt, AContradictionHidesNoProvenFault) {
  SyntheticRun run = withBeltScaled(-0.005);
  run.shiftSpot(0, kCreaseLine, [](double t_s) { return Eigen::Vector2d(2.0 * t_s, 0.0); });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "belt").verdict, Verdict::kInvalid);
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kFail);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(Belt, WithoutAnEncoderThereIsNothingToCompare) {
  SyntheticRun run;
  run.evidence.belt.clear();
  EXPECT_FALSE(hasCheck(run.inspected(), "belt"));
  EXPECT_EQ(run.inspected().verdict, Verdict::kPass);
}

TEST(Belt, AnEncoderTooCoarseToTellIsNotAsked) {
  SyntheticRun run;
  run.evidence.belt_count_mm = 0.031;  // U of two ends: 0.0253 mm, half of the limit is 0.025
  EXPECT_FALSE(hasCheck(run.inspected(), "belt"));
  run.evidence.belt_count_mm = 0.030;
  EXPECT_TRUE(hasCheck(run.inspected(), "belt"));
}

TEST(Belt, EdgesOutOfOrderAreNoEvidence) {
  SyntheticRun run;
  std::swap(run.evidence.belt[500], run.evidence.belt[501]);
  const auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
  EXPECT_THAT(result.problems.front(), HasSubstr("encoder"));
}

}  // namespace
}  // namespace kerfbench::inspect

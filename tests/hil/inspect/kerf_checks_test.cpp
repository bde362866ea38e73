// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void unburn(vision::Caliper& c) {
  c.found = false;
  c.offset_mm = c.width_mm = kNan;
  c.brightness = 0.0;
}

TEST(PathCheck, ProvesADeviationAndSaysWhere) {
  SyntheticRun run;
  run.kerf(1, kRight).calipers[80].offset_mm = -0.08;
  const auto result = run.inspected();
  const Check& path = checkOf(result, "path");
  EXPECT_EQ(path.verdict, Verdict::kFail);
  EXPECT_EQ(path.subject, "unit 1, E1");
  EXPECT_NE(path.explanation.find("to the right of the line at x 60.00, y 20.00 mm"), std::string::npos)
      << path.explanation;
  EXPECT_NEAR(path.value, 0.08, 0.005);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  for (const EntityResult& e : result.entities) {
    if (e.unit == 1 && e.entity == kRight) {
      EXPECT_NEAR(e.worst_mm, -0.08, 0.005) << "right of the line is negative";
    }
  }
}

TEST(PathCheck, AtTheLimitNothingIsProven) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[100].offset_mm = 0.051;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kNotProven);
  EXPECT_EQ(run.inspected().verdict, Verdict::kNotProven);
}

TEST(PathCheck, LeavesOutJoints) {
  SyntheticRun run;
  run.kerf(0, kTop).calipers[0].offset_mm = 0.3;
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kPass);
}

TEST(PathCheck, WithoutStatedUncertaintyIsInvalid) {
  SyntheticRun run;
  run.evidence.kerf_calibration.reset();
  EXPECT_EQ(checkOf(run.inspected(), "path").verdict, Verdict::kInvalid);
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(CoverageCheck, FindsAMissingEntity) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kHole).calipers) unburn(c);
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "coverage").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "coverage").subject, "unit 1, E4");
  EXPECT_EQ(checkOf(result, "path").verdict, Verdict::kPass) << "what is there lies well";
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(CoverageCheck, FindsAHoleAndNamesItsPlace) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kBottom).calipers;
  for (std::size_t i = 100; i <= 104; ++i) unburn(calipers[i]);
  const auto result = run.inspected();
  const Check& coverage = checkOf(result, "coverage");
  EXPECT_EQ(coverage.verdict, Verdict::kFail);
  EXPECT_NE(coverage.explanation.find("from station 25.00 to 26.00 mm"), std::string::npos)
      << coverage.explanation;
}

TEST(CoverageCheck, ACutThatIsOnlyScoredIsNotCut) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(0, kLeft).calipers) c.brightness = 0.6;
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kFail);
}

TEST(CoverageCheck, CountsStationsNearJointsByTheirLight) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(0, kLeft).calipers) {
    if (c.near_joint) c.found = false;
  }
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kPass);
}

TEST(CoverageCheck, ABlankSheetIsABadReleaseAndNotBadEvidence) {
  SyntheticRun run;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) unburn(c);
  }
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.spot_W_mm.reset();
  const auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_FALSE(hasCheck(result, "path"));
  EXPECT_NE(checkOf(result, "coverage").explanation.find("Nothing was cut"), std::string::npos);
}

TEST(DepthCheck, ACreaseCutThroughFails) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kCreaseLine).calipers;
  for (std::size_t i = 40; i < 60; ++i) calipers[i].brightness = 1.0;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "depth").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "depth").subject, "unit 0, E5");
}

TEST(DepthCheck, DoesNotApplyWithoutCreases) {
  SyntheticRun run;
  run.dieline.entities[kCreaseLine].process = dieline::Process::kCut;
  EXPECT_FALSE(hasCheck(run.inspected(), "depth"));
}

TEST(DepthCheck, AHalfCutCutThroughFails) {
  SyntheticRun run;
  run.dieline.entities[kCreaseLine].process = dieline::Process::kHalfCut;
  EXPECT_EQ(checkOf(run.inspected(), "depth").verdict, Verdict::kPass);
  auto& calipers = run.kerf(1, kCreaseLine).calipers;
  for (std::size_t i = 40; i < 60; ++i) calipers[i].brightness = 1.0;
  EXPECT_EQ(checkOf(run.inspected(), "depth").verdict, Verdict::kFail);
}

TEST(PerforationCheck, ComparesTheOpenShareWithTheOrder) {
  SyntheticRun run;
  run.limits.perforation_open_share = 0.75;
  EXPECT_EQ(checkOf(run.inspected(), "perforation").verdict, Verdict::kPass);
  for (const double too_different : {0.5, 0.95}) {
    run.limits.perforation_open_share = too_different;
    EXPECT_EQ(checkOf(run.inspected(), "perforation").verdict, Verdict::kFail) << too_different;
  }
}

TEST(PerforationCheck, WithoutBridgesFailsEvenWithoutAnOrder) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(0, kPerforationLine).calipers) {
    c.found = true;
    c.offset_mm = 0.0;
    c.width_mm = 0.21;
    c.sigma_mm = c.width_sigma_mm = 0.001;
    c.brightness = 1.0;
  }
  EXPECT_EQ(checkOf(run.inspected(), "perforation").verdict, Verdict::kFail);
}

TEST(KerfWidthCheck, FindsTheLineThatIsWider) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.07;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "kerf_width").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "kerf_width").subject, "unit 1, E2");
}

TEST(KerfWidthCheck, NearTheLimitLooseWidthsProveNothing) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_mm += 0.048;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kPass);
  // A mean of 240 stations is sixteen times better than one: 3 um. Less is not proven by much.
  for (vision::Caliper& c : run.kerf(1, kTop).calipers) c.width_sigma_mm = 0.05;
  EXPECT_EQ(checkOf(run.inspected(), "kerf_width").verdict, Verdict::kNotProven);
}

TEST(StrayCheck, OneOfUnknownSizeIsInvalid) {
  SyntheticRun run;
  for (const double extent_mm : {0.2, kNan, 0.3})
    run.evidence.kerf.strays.push_back({0, {33, 12}, extent_mm});
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(StrayCheck, FailsOnWhatIsBurntBeside) {
  SyntheticRun run;
  run.evidence.kerf.strays.push_back({0, {10, 3}, 0.3});
  run.evidence.kerf.strays.push_back({1, {33, 12}, 4.2});
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stray").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(result, "stray").explanation.find("4.20 mm long, at x 33.00, y 12.00 mm of unit 1"),
            std::string::npos);
}

TEST(LaserTimingCheck, FindsAStartThatIsNotBurnt) {
  SyntheticRun run;
  // A laser 2 ms late leaves about 0.28 mm without enough power at each start.
  unburn(run.kerf(0, kBottom).calipers[0]);
  run.kerf(0, kBottom).calipers[1].brightness = 0.2;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "laser_timing").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "laser_timing").value, 0.34, 0.02);
  EXPECT_NE(checkOf(result, "laser_timing").explanation.find("At the start of unit 0, E0"),
            std::string::npos);
}

TEST(LaserTimingCheck, AShortGapIsNoMatterOfCoverage) {
  SyntheticRun run;
  run.limits.end_gap_mm = 0.3;
  run.limits.min_coverage = 1.0;
  for (vision::Caliper* c :
       {&run.kerf(0, kCreaseLine).calipers.front(), &run.kerf(0, kCreaseLine).calipers.back()})
    unburn(*c);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").value, 1.0);
}

TEST(LaserTimingCheck, SeesTheGapBehindANeighboursKerf) {
  SyntheticRun run;
  // The end point itself is bright with the kerf of the adjoining line.
  auto& calipers = run.kerf(0, kTop).calipers;
  calipers[calipers.size() - 2].brightness = 0.0;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(run.inspected(), "laser_timing").explanation.find("At the end of"), std::string::npos);
}

TEST(LaserTimingCheck, AHalfLitEndIsNoGap) {
  SyntheticRun run;
  // The tip of a slit: the end point gets half of the line's energy.
  run.kerf(0, kBottom).calipers[0].brightness = 0.4;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kPass);
}

}  // namespace
}  // namespace kerfbench::inspect

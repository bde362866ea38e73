// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
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
  EXPECT_NE(coverage.explanation.find("between station 25.00 and 26.00 mm"), std::string::npos)
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
  // The mean of 240 stations is sixteen times better than one: 3 um. A smaller deviation is hardly proven.
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
  // A laser that is 2 ms late leaves about 0.28 mm without enough power at each start.
  unburn(run.kerf(0, kBottom).calipers[0]);
  run.kerf(0, kBottom).calipers[1].brightness = 0.2;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "laser_timing").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "laser_timing").value, 0.34, 0.02);
  EXPECT_NE(checkOf(result, "laser_timing").explanation.find("At the start of unit 0, E0"),
            std::string::npos);
}

/// Dims the calipers of a line as a bridge of this length about a place does, seen over 0.2 mm each.
void bridge(vision::EntityKerf& kerf, double middle_mm, double length_mm) {
  for (vision::Caliper& c : kerf.calipers) {
    const double from_mm = std::max(c.station_mm - 0.1, middle_mm - 0.5 * length_mm);
    const double to_mm = std::min(c.station_mm + 0.1, middle_mm + 0.5 * length_mm);
    c.brightness *= 1.0 - std::max(0.0, to_mm - from_mm) / 0.2;
    if (c.brightness < 0.03) unburn(c);
  }
}

/// A line of stations every 0.1 mm instead of the run's own.
void refine(vision::EntityKerf& kerf) {
  std::vector<vision::Caliper> fine;
  for (std::size_t i = 0; i + 1 < kerf.calipers.size(); ++i) {
    const vision::Caliper& a = kerf.calipers[i];
    const vision::Caliper& b = kerf.calipers[i + 1];
    const int pieces = static_cast<int>(std::ceil((b.station_mm - a.station_mm) / 0.1 - 1e-9));
    for (int k = 0; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      vision::Caliper c = a;
      c.station_mm += t * (b.station_mm - a.station_mm);
      c.u += t * (b.u - a.u);
      c.p_S_mm += t * (b.p_S_mm - a.p_S_mm);
      c.p_V_mm += t * (b.p_V_mm - a.p_V_mm);
      fine.push_back(c);
    }
  }
  fine.push_back(kerf.calipers.back());
  kerf.calipers = std::move(fine);
}

TEST(CoverageCheck, MeasuresABridgeWhateverTheLengthOfItsLine) {
  for (const double length_mm : {0.1, 0.15, 0.2, 0.3, 0.7, 7.5}) {
    for (const double middle_mm : {20.0, 20.03, 20.05}) {
      SyntheticRun run;
      vision::EntityKerf& kerf = run.kerf(0, kBottom);
      refine(kerf);
      bridge(kerf, middle_mm, length_mm);
      const auto result = run.inspected();
      const Check& coverage = checkOf(result, "coverage");
      EXPECT_NEAR(coverage.value, length_mm, coverage.u) << length_mm << " at " << middle_mm;
      const Verdict wanted = length_mm > 0.2 + 1e-9   ? Verdict::kFail
                             : length_mm < 0.1 - 1e-9 ? Verdict::kPass
                                                      : coverage.verdict;
      EXPECT_EQ(coverage.verdict, wanted) << length_mm << " at " << middle_mm;
      if (length_mm <= 0.15) continue;
      EXPECT_NE(coverage.verdict, Verdict::kPass) << length_mm << " at " << middle_mm;
    }
  }
}

TEST(CoverageCheck, ALineThatIsDimAllAlongIsNotCut) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(0, kBottom).calipers) c.brightness = 0.7;
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kFail);
}

TEST(DepthCheck, MeasuresTheLongestPieceThatIsCutThrough) {
  SyntheticRun run;
  auto& calipers = run.kerf(1, kCreaseLine).calipers;
  for (std::size_t i = 50; i <= 54; ++i) calipers[i].brightness = 1.0;
  const auto result = run.inspected();
  const Check& depth = checkOf(result, "depth");
  EXPECT_EQ(depth.verdict, Verdict::kFail);
  EXPECT_NEAR(depth.value, 5 * 0.25, 0.01);
  EXPECT_EQ(depth.subject, "unit 1, E5");
  EXPECT_EQ(checkOf(result, "coverage").verdict, Verdict::kPass) << "one cause, one check";
}

TEST(LaserTimingCheck, AShortGapIsNoMatterOfCoverage) {
  SyntheticRun run;
  run.limits.end_gap_mm = 0.3;
  for (vision::Caliper* c :
       {&run.kerf(0, kCreaseLine).calipers.front(), &run.kerf(0, kCreaseLine).calipers.back()})
    unburn(*c);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").value, 0.0);
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
  // At the tip of a slit the end point gets half of the line's energy.
  run.kerf(0, kBottom).calipers[0].brightness = 0.4;
  EXPECT_EQ(checkOf(run.inspected(), "laser_timing").verdict, Verdict::kPass);
}

}  // namespace
}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
// Whether lines are burnt at all, without a break, and creases not through.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

TEST(CoverageCheck, FindsAMissingEntity) {
  SyntheticRun run;
  for (vision::Caliper& c : run.kerf(1, kHole).calipers) unburn(c);
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "coverage").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "coverage").subject, "unit 1, E4");
  EXPECT_EQ(checkOf(result, "coverage").explanation.find("1 of 12 entities have an uncut piece"), 0U)
      << checkOf(result, "coverage").explanation;
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
  for (const double brightness : {0.6, 0.7}) {
    SyntheticRun run;
    for (vision::Caliper& c : run.kerf(0, kLeft).calipers) c.brightness = brightness;
    EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kFail) << brightness;
  }
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

TEST(CoverageCheck, LightBesideABridgeDoesNotMakeUpForIt) {
  SyntheticRun run;
  vision::EntityKerf& kerf = run.kerf(0, kBottom);
  refine(kerf);
  bridge(kerf, 20.0, 0.3);
  const double length_mm = checks::longestUncut(run.evidence, kerf, run.limits).length_mm;
  // Heat that the bridge kept from the board widens the kerf on either side of it.
  for (vision::Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - 20.0);
    if (away_mm > 0.24 && away_mm < 0.6) c.brightness *= 1.25;
  }
  EXPECT_NEAR(checks::longestUncut(run.evidence, kerf, run.limits).length_mm, length_mm, 1e-9);
}

/// Bridges of one length, evenly over a line, away from its ends.
void bridges(vision::EntityKerf& kerf, int count, double length_mm) {
  refine(kerf);
  const double from_mm = 3.0;
  const double step_mm = (kerf.calipers.back().station_mm - 2.0 * from_mm) / count;
  for (int i = 0; i < count; ++i) bridge(kerf, from_mm + (i + 0.37) * step_mm, length_mm);
}

TEST(BridgesCheck, GoodCutsHaveNone) {
  SyntheticRun run;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "bridges").value, 0.0);
  EXPECT_EQ(checkOf(result, "bridges").verdict, Verdict::kPass);
}

TEST(BridgesCheck, FiftyOfATenthOfAMillimetreFail) {
  SyntheticRun run;
  bridges(run.kerf(1, kBottom), 50, 0.1);
  const auto result = run.inspected();
  EXPECT_NE(checkOf(result, "coverage").verdict, Verdict::kFail) << "each is short enough";
  const Check& check = checkOf(result, "bridges");
  EXPECT_EQ(check.verdict, Verdict::kFail) << check.explanation;
  EXPECT_NE(check.subject.find("unit 1"), std::string::npos) << check.subject;
  EXPECT_NE(check.explanation.find("50 uncut pieces"), std::string::npos) << check.explanation;
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(BridgesCheck, MeasuresTheSumOfThePieces) {
  for (const double length_mm : {0.04, 0.07, 0.1, 0.14}) {
    for (const int count : {2, 7, 25}) {
      SyntheticRun run;
      vision::EntityKerf& kerf = run.kerf(0, kBottom);
      bridges(kerf, count, length_mm);
      run.limits.uncut_share = 1.0;
      const Check check = *checks::bridgesCheck(run.evidence, run.limits);
      const double truth = (count - 1) * length_mm / dieline::lengthOf(run.dieline.entities[kBottom].curve);
      EXPECT_NEAR(check.value, truth, check.u) << count << " of " << length_mm;
      EXPECT_LT(check.u, 0.1 * truth + 0.004) << count << " of " << length_mm;
    }
  }
}

TEST(BridgesCheck, OneBridgeIsTheBusinessOfCoverage) {
  SyntheticRun run;
  bridges(run.kerf(0, kBottom), 1, 0.14);
  EXPECT_EQ(checkOf(run.inspected(), "bridges").value, 0.0);
}

TEST(BridgesCheck, ABridgeInEachLineOfAnOutlineHoldsItToo) {
  SyntheticRun run;
  for (const int id : {kBottom, kRight, kTop, kLeft}) bridges(run.kerf(0, id), 1, 0.14);
  // One in each of 200 mm of outline: 0.42 mm beside the longest. None of the lines by itself has two.
  run.limits.uncut_share = 0.001;
  const Check check = checkOf(run.inspected(), "bridges");
  EXPECT_EQ(check.verdict, Verdict::kFail) << check.explanation;
  EXPECT_NEAR(check.value, 0.42 / 200.0, check.u);
  EXPECT_NE(check.explanation.find("outline of 4 lines"), std::string::npos) << check.explanation;
}

TEST(BridgesCheck, ALineThatIsDimmerOnOneSideHasNone) {
  SyntheticRun run;
  vision::EntityKerf& kerf = run.kerf(0, kBottom);
  refine(kerf);
  const double length_mm = kerf.calipers.back().station_mm;
  for (vision::Caliper& c : kerf.calipers) c.brightness *= 0.95 + 0.1 * c.station_mm / length_mm;
  EXPECT_EQ(checkOf(run.inspected(), "bridges").value, 0.0);
}

TEST(BridgesCheck, OneWhereACircleClosesCountsAsAnyOther) {
  SyntheticRun run;
  vision::EntityKerf& kerf = run.kerf(0, kHole);
  for (const std::size_t at : {0U, 70U}) bridge(kerf, kerf.calipers[at].station_mm, 0.14);
  const Finding check = checks::bridgesCheck(run.evidence, run.limits);
  EXPECT_NE(check->explanation.find("2 uncut pieces"), std::string::npos) << check->explanation;
}

TEST(BridgesCheck, PiecesOfACreaseHoldNothing) {
  SyntheticRun run;
  bridges(run.kerf(0, kCreaseLine), 20, 0.1);
  EXPECT_EQ(checks::bridgesCheck(run.evidence, run.limits)->value, 0.0);
}

TEST(BridgesCheck, DoesNotApplyWithoutCuts) {
  SyntheticRun run;
  for (dieline::Entity& entity : run.dieline.entities)
    if (entity.process == dieline::Process::kCut) entity.process = dieline::Process::kHalfCut;
  const auto result = run.inspected();
  EXPECT_FALSE(hasCheck(result, "bridges"));
  EXPECT_FALSE(unjudgedOf(result, "bridges").applies);
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

/// A crease of which the camera sees this share of the light, from station to station.
void dim(vision::EntityKerf& kerf, double from_mm, double to_mm, double brightness) {
  for (vision::Caliper& c : kerf.calipers)
    if (c.station_mm >= from_mm && c.station_mm <= to_mm) c.brightness = brightness;
}

TEST(CoverageCheck, AFaintCreaseIsNotProvenUnlessItsDepthIsOrdered) {
  SyntheticRun run;
  dim(run.kerf(1, kCreaseLine), 0.0, 40.0, 0.06);
  // Noise hides it at one station, where it is a little dimmer.
  unburn(run.kerf(1, kCreaseLine).calipers[50]);
  run.kerf(1, kCreaseLine).calipers[50].brightness = 0.04;
  const auto result = run.inspected();
  const Check& faint = checkOf(result, "coverage");
  EXPECT_EQ(faint.verdict, Verdict::kNotProven);
  EXPECT_EQ(faint.subject, "unit 1, E5");
  EXPECT_NE(faint.explanation.find("checks.crease_depth"), std::string::npos) << faint.explanation;
  run.limits.crease_depth = {.least = 0.5, .most = 0.9};
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kPass);
}

TEST(CoverageCheck, AShortFaintCreaseIsNoHoleEither) {
  // No more than five of its stations lie away from its ends: they bear each other out.
  SyntheticRun run;
  constexpr double kLength_mm = 1.4;
  run.dieline.entities[kCreaseLine].curve = dieline::LineCurve{{30.0, 2.0}, {30.0, 2.0 + kLength_mm}};
  vision::EntityKerf& kerf = run.kerf(1, kCreaseLine);
  kerf.calipers.resize(7);
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i)
    kerf.calipers[i].station_mm =
        kLength_mm * static_cast<double>(i) / static_cast<double>(kerf.calipers.size() - 1);
  dim(kerf, 0.0, kLength_mm, 0.06);
  EXPECT_EQ(checks::longestBlank(run.evidence, kerf, run.limits).length_mm, 0.0);
  unburn(kerf.calipers[3]);
  EXPECT_GT(checks::longestBlank(run.evidence, kerf, run.limits).length_mm, 0.0);
}

TEST(CoverageCheck, AFaintCutIsNoCut) {
  SyntheticRun run;
  dim(run.kerf(1, kTop), 10.0, 12.0, 0.06);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kFail);
}

TEST(CoverageCheck, GrainIsFoundHereAndThereAndIsNoCrease) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kCreaseLine).calipers;
  for (std::size_t i = 20; i < 40; ++i) {
    calipers[i].brightness = 0.06;
    // Flocks that are two stations long lie anywhere within the caliper.
    calipers[i].offset_mm = 0.3 * std::sin(2.4 * static_cast<double>(i / 2));
  }
  const auto result = run.inspected();
  const Check& coverage = checkOf(result, "coverage");
  EXPECT_EQ(coverage.verdict, Verdict::kFail) << coverage.explanation;
  EXPECT_EQ(coverage.subject, "unit 0, E5");
}

TEST(CoverageCheck, GrainInPicturesIsNoCreaseWhereTheLaserWasOff) {
  for (const double length_mm : {0.1, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      vision::test::TwinCut cut;
      cut.seed = cut.camera.board_seed = seed;
      cut.board.transmission = 0.3;
      cut.camera.texture = {.grain_gray = 3.0, .grain_length_mm = length_mm};
      cut.add(dieline::LineCurve{{-10.0, -6.0}, {10.0, -6.0}});
      // The laser is off over the second half of the crease.
      const int crease = cut.add(dieline::LineCurve{{-10.0, 0.0}, {10.0, 0.0}}, dieline::Process::kCrease);
      cut.share_of[crease] = 0.0;
      cut.also = [&](twin::Sheet& sheet) { cut.burn(sheet, {-10.0, 0.0}, {0.0, 0.0}, 0.7); };
      SyntheticRun run;
      run.evidence.dieline = &cut.dieline;
      run.evidence.kerf = cut.scan();
      const checks::Stretch blank =
          checks::longestBlank(run.evidence, vision::test::entityOf(run.evidence.kerf, crease), run.limits);
      EXPECT_GT(blank.length_mm, 3.0) << length_mm << " mm, seed " << seed;
      EXPECT_GT(blank.from_mm, 9.9);
    }
  }
}

TEST(CoverageCheck, AHoleInAFaintCreaseIsAHole) {
  SyntheticRun run;
  auto& calipers = run.kerf(0, kCreaseLine).calipers;
  dim(run.kerf(0, kCreaseLine), 0.0, 40.0, 0.06);
  for (std::size_t i = 60; i < 68; ++i) unburn(calipers[i]);
  // Another faint one is longer, but this one is proven.
  dim(run.kerf(1, kCreaseLine), 0.0, 40.0, 0.06);
  const auto result = run.inspected();
  const Check& coverage = checkOf(result, "coverage");
  EXPECT_EQ(coverage.verdict, Verdict::kFail) << coverage.explanation;
  EXPECT_EQ(coverage.subject, "unit 0, E5");
}

TEST(DepthCheck, NearlyTheLightOfACutProvesNothing) {
  SyntheticRun run;
  dim(run.kerf(0, kCreaseLine), 10.0, 12.0, 0.85);
  const auto result = run.inspected();
  const Check& depth = checkOf(result, "depth");
  EXPECT_EQ(depth.verdict, Verdict::kNotProven) << depth.explanation;
  EXPECT_EQ(depth.subject, "unit 0, E5");
  EXPECT_NE(depth.explanation.find("nearly the light of a cut over 2.2"), std::string::npos)
      << depth.explanation;
  // The longer one does not hide the one that is proven.
  dim(run.kerf(1, kCreaseLine), 10.0, 10.6, 0.99);
  const auto proven = run.inspected();
  EXPECT_EQ(checkOf(proven, "depth").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(proven, "depth").subject, "unit 1, E5");
}

TEST(DepthCheck, StationsBesideOneThatIsSurelyOpenAreAsWell) {
  // Calipers beside a hole reach over its end, and so see less of its light.
  SyntheticRun run;
  vision::EntityKerf& kerf = run.kerf(0, kCreaseLine);
  refine(kerf);
  kerf.calipers[100].brightness = 1.0;
  kerf.calipers[99].brightness = kerf.calipers[101].brightness = 0.8;
  const double pitch_mm = kerf.calipers[101].station_mm - kerf.calipers[100].station_mm;
  run.limits.cut_through_mm = 2.0 * pitch_mm;
  const Check depth = *checks::depthCheck(run.evidence, run.limits);
  EXPECT_NEAR(depth.value, 3.0 * pitch_mm, 1e-9);
  EXPECT_NE(depth.explanation.find("is cut through over"), std::string::npos) << depth.explanation;
}

TEST(BridgesCheck, StationsThatShineDoNotMakeTheOthersLackLight) {
  // One in eight, as under a lamp that is seen in the board.
  SyntheticRun run;
  auto& calipers = run.kerf(0, kBottom).calipers;
  for (std::size_t i = 4; i < calipers.size(); i += 8) calipers[i].brightness *= 1.3;
  EXPECT_EQ(checks::bridgesCheck(run.evidence, run.limits)->value, 0.0);
}

TEST(CoverageCheck, AGrooveThatKeepsItsPlaceAtTwoStationsOfThreeIsNone) {
  SyntheticRun run;
  vision::EntityKerf& kerf = run.kerf(1, kCreaseLine);
  dim(kerf, 0.0, 40.0, 0.06);
  EXPECT_EQ(checks::longestBlank(run.evidence, kerf, run.limits).length_mm, 0.0);
  for (std::size_t i = 0; i < kerf.calipers.size(); i += 3) kerf.calipers[i].offset_mm += 0.2;
  EXPECT_GT(checks::longestBlank(run.evidence, kerf, run.limits).length_mm, 20.0);
}

}  // namespace
}  // namespace kerfbench::inspect

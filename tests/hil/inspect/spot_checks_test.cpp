// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "hil/inspect/spot_association.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::hil {
namespace {

using namespace testing;

TEST(FollowDieline, PutsEverySpotOnTheEntityThatItFollows) {
  SyntheticRun run;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  EXPECT_EQ(lit.unplaced, 0U);
  EXPECT_EQ(lit.frames.size(), lit.lit);
  for (const LitFrame& frame : lit.frames) {
    EXPECT_GE(frame.entity, 0) << frame.time_s;
    EXPECT_LT(std::abs(frame.deviation_mm), 0.015);
  }
}

TEST(FollowDieline, KeepsTheLineWhereItCrossesAnother) {
  SyntheticRun run;
  run.dieline.entities[kNote] = {kNote, LineCurve{{20, 10.13}, {40, 10.13}}, Process::kIgnore, "", ""};
  run.dieline.entities[kNote].process = Process::kCut;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  for (const LitFrame& frame : lit.frames) EXPECT_NE(frame.entity, kNote) << frame.time_s;
}

TEST(StillnessCheck, FindsADriftAlongXAndMeasuresIt) {
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double t_s) { return Eigen::Vector2d(t_s / 0.12 * 0.09, 0.0); });
  const auto result = run.inspected();
  const Check& stillness = checkOf(result, "stillness_x");
  EXPECT_EQ(stillness.verdict, Verdict::kFail);
  EXPECT_EQ(stillness.subject, "unit 1, E5");
  EXPECT_NEAR(stillness.value, 0.09, 0.008);
  EXPECT_EQ(checkOf(result, "path").verdict, Verdict::kPass);
}

TEST(StillnessCheck, AConstantOffsetIsTheMatterOfThePath) {
  SyntheticRun run;
  run.shiftSpot(0, kCreaseLine, [](double) { return Eigen::Vector2d(0.12, 0.0); });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(result, "spot_path").verdict, Verdict::kFail);
}

TEST(StillnessCheck, WithoutLinesAcrossTheBeltIsInvalid) {
  SyntheticRun run;
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline).frames) {
    if (frame.entity != kBottom && frame.entity != kTop)
      run.evidence.spot.frames[frame.frame].spot_W_mm.reset();
  }
  for (auto& e : run.dieline.entities) {
    if (e.id != kBottom && e.id != kTop) e.process = Process::kIgnore;
  }
  std::erase_if(run.evidence.kerf.entities,
                [](const EntityKerf& k) { return k.entity != kBottom && k.entity != kTop; });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kInvalid);
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
}

TEST(StillnessCheck, AFirmwareThatIgnoresTheBeltFails) {
  SyntheticRun run;
  // The mirrors stand where a resting sheet would have them: the spot stays behind by v t.
  for (FrameMeasurement& frame : run.evidence.spot.frames) {
    if (frame.spot_W_mm) frame.spot_W_mm->x() -= 200.0 * (frame.mid_s + 0.05);
  }
  for (EntityKerf& kerf : run.evidence.kerf.entities) {
    for (Caliper& c : kerf.calipers) {
      c.found = false;
      c.brightness = 0.0;
      c.offset_mm = c.width_mm = std::numeric_limits<double>::quiet_NaN();
    }
  }
  run.evidence.kerf.strays.push_back({0, {30, 20}, 60.0});
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "spot_path").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kFail)
      << checkOf(result, "stillness_x").explanation;
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(StillnessCheck, UncertaintyFollowsTheNumberOfFrames) {
  SyntheticRun run;
  for (const CutResult& cut : run.inspected().cuts) {
    if (cut.entity != kCreaseLine) continue;
    EXPECT_EQ(cut.frames, 120);
    // Spot 2 um; sheet 1 um by four marks, three of which can disagree.
    EXPECT_NEAR(cut.drift_sigma_mm, std::hypot(0.002, 0.001 / std::sqrt(3.0)) * std::sqrt(12.0 / 120), 5e-5);
    EXPECT_NEAR(cut.slope_sigma_mm_s, cut.drift_sigma_mm / 0.119, 1e-6);
  }
}

TEST(RepeatCheck, FindsALineThatIsCutTwice) {
  SyntheticRun run;
  run.followAgain(0, kHole);
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "repeat").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "repeat").subject, "unit 0, E4");
  EXPECT_NEAR(checkOf(result, "repeat").value, 2.0, 0.05);
}

TEST(RepeatCheck, CountsAFlawlessLineOnce) {
  SyntheticRun run;
  for (const EntityResult& e : run.inspected().entities) EXPECT_NEAR(e.passes, 1.0, 0.12) << e.entity;
}

TEST(LaserGateCheck, LightWithoutGateFails) {
  SyntheticRun run;
  for (GateInterval& gate : run.evidence.gates) gate.off_s -= 0.005;
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kFail);
  run.evidence.gates.clear();
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kInvalid);
}

TEST(PulseTimingCheck, NamesAxisKindAndTimes) {
  SyntheticRun run;
  run.evidence.pulses[1].min_setup_s = 0.125e-6;
  run.evidence.pulses[1].setup_violations = 37;
  run.evidence.pulses[1].first_violation_s = 1.25;
  const auto result = run.inspected();
  const Check& check = checkOf(result, "pulse_timing");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_EQ(check.subject, "galvo_y");
  EXPECT_NE(check.explanation.find("37 break"), std::string::npos) << check.explanation;
  EXPECT_NE(check.explanation.find("DIR set-up of galvo_y: 0.125 us"), std::string::npos)
      << check.explanation;
}

TEST(PulseTimingCheck, AnAxisThatNeverTurnedHasNoSetUpTime) {
  SyntheticRun run;
  run.evidence.pulses[0].min_setup_s = run.evidence.pulses[0].min_hold_s =
      std::numeric_limits<double>::infinity();
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kPass);
}

TEST(PulseTimingCheck, WithoutAnyPulseIsInvalid) {
  SyntheticRun run;
  for (PulseTiming& t : run.evidence.pulses) t.pulses = 0;
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kInvalid);
}

TEST(PulseTimingCheck, ARealStampErrorOpensAGuardBand) {
  SyntheticRun run;
  run.evidence.pin_u_s = 1e-6;
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kNotProven);
}

}  // namespace
}  // namespace kerfbench::hil

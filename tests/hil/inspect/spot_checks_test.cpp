// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/spot_association.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using ::testing::HasSubstr;

TEST(SpotBesideEveryLine, IsProvenByItsPathAndTellsNoStillness) {
  const auto shifted = [](const Eigen::Vector2d& shift_mm) {
    SyntheticRun run;
    for (vision::FrameMeasurement& frame : run.evidence.spot.frames)
      if (frame.spot_W_mm) *frame.spot_W_mm += shift_mm;
    return run.inspected();
  };
  const InspectionResult beside = shifted({0.5, 0.5});
  EXPECT_EQ(beside.verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(beside, "spot_path").verdict, Verdict::kFail);
  for (const char* name : {"stillness_x", "stillness_peak", "repeat", "gate_lag"})
    EXPECT_TRUE(unjudgedOf(beside, name).applies) << name;
  // Half a millimetre to both sides crosses the round hole's line, and no other.
  for (const CutResult& cut : beside.cuts) EXPECT_TRUE(cut.entity == -1 || cut.entity == kHole) << cut.entity;
  // Near enough to be followed all are judged, and a constant offset is no motion.
  const InspectionResult near = shifted({0.15, 0.0});
  EXPECT_EQ(checkOf(near, "spot_path").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(near, "stillness_x").verdict, Verdict::kPass);
}

TEST(SpotProblems, ASheetWhosePlaceIsUnknownMostOfTheTimeIsTold) {
  const auto tells = [](const SyntheticRun& run) {
    for (const std::string& problem : run.inspected().problems) {
      if (problem.find("no printed mark told where the sheet was") != std::string::npos) return true;
    }
    return false;
  };
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  for (std::size_t i = 0; i < frames.size() * 3 / 10; ++i) frames[i].sheet.clear();
  EXPECT_FALSE(tells(run));
  for (std::size_t i = 0; i < frames.size() * 7 / 10; ++i) frames[i].sheet.clear();
  EXPECT_TRUE(tells(run));
}

TEST(TopSpeed, OfAStraightCutIsThatOfTheBeam) {
  const SyntheticRun run;
  const auto result = run.inspected();
  int straight = 0;
  for (const CutResult& cut : result.cuts) {
    if (cut.entity != kBottom && cut.entity != kTop) continue;
    EXPECT_NEAR(cut.top_speed_mm_s, 300.0, 2.0 * cut.top_speed_U_mm_s);
    EXPECT_LT(cut.top_speed_U_mm_s, 30.0);
    ++straight;
  }
  EXPECT_EQ(straight, 2) << "the first cut of each unit";
}

TEST(StillnessCheck, FindsADriftAlongXAndMeasuresIt) {
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double t_s) { return Eigen::Vector2d(t_s / 0.12 * 0.09, 0.0); });
  const auto result = run.inspected();
  const Check& stillness = checkOf(result, "stillness_x");
  EXPECT_EQ(stillness.verdict, Verdict::kFail);
  EXPECT_EQ(stillness.subject, "unit 1, E5");
  EXPECT_NEAR(stillness.value, 0.09, 0.008);
  for (const CutResult& cut : result.cuts) {
    if (cut.unit == 1 && cut.entity == kCreaseLine) {
      EXPECT_NEAR(cut.drift_mm, 0.09, 0.008) << "along +x";
    }
  }
  EXPECT_EQ(checkOf(result, "path").verdict, Verdict::kPass);
}

/// A laser's PWM may leave a frame dark now and then. Between two of them the beam drifts by 0.015 mm, which
/// is within the limit.
TEST(StillnessCheck, ADriftIsMeasuredOverTheWholeCutThoughFramesOfItAreDark) {
  SyntheticRun run;
  run.shiftSpot(1, kCreaseLine, [](double t_s) { return Eigen::Vector2d(t_s / 0.12 * 0.09, 0.0); });
  auto& frames = run.evidence.spot.frames;
  for (const GateInterval& gate : run.evidence.gates) {
    for (std::size_t i = run.frameAt(gate.on_s) + 10; frames[i].mid_s < gate.off_s - 0.01; i += 20)
      frames[i].spot_W_mm.reset();
  }
  const Check check = checkOf(run.inspected(), "stillness_x");
  EXPECT_EQ(check.verdict, Verdict::kFail) << check.explanation;
  EXPECT_NEAR(check.value, 0.09, 0.008) << check.explanation;
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
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline, run.evidence.gates).frames) {
    if (frame.entity != kBottom && frame.entity != kTop)
      run.evidence.spot.frames[frame.frame].spot_W_mm.reset();
  }
  for (auto& e : run.dieline.entities) {
    if (e.id != kBottom && e.id != kTop) e.process = dieline::Process::kIgnore;
  }
  std::erase_if(run.evidence.kerf.entities,
                [](const vision::EntityKerf& k) { return k.entity != kBottom && k.entity != kTop; });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "stillness_x").verdict, Verdict::kInvalid);
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
}

TEST(StillnessCheck, AFirmwareThatIgnoresTheBeltFails) {
  SyntheticRun run;
  // The mirrors stand where a resting sheet would have them: the spot stays behind by v t.
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (frame.spot_W_mm) frame.spot_W_mm->x() -= 200.0 * (frame.mid_s + 0.05);
  }
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) {
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
  EXPECT_THAT(checkOf(result, "stillness_x").subject, HasSubstr("along no drawn line at x"));
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(StillnessCheck, UncertaintyFollowsTheNumberOfFrames) {
  SyntheticRun run;
  for (const CutResult& cut : run.inspected().cuts) {
    if (cut.entity != kCreaseLine) continue;
    EXPECT_EQ(cut.frames, 120);
    // The spot has 2 um; the sheet 1 um by four marks, three of which are independent.
    EXPECT_NEAR(cut.drift_sigma_mm, std::hypot(0.002, 0.001 / std::sqrt(3.0)) * std::sqrt(12.0 / 120), 5e-5);
    EXPECT_NEAR(cut.slope_sigma_mm_s, cut.drift_sigma_mm / 0.119, 1e-6);
  }
}

TEST(StillnessCheck, WhatTheCameraDoesNotKnowAlongALineIsNoDriftAcrossIt) {
  // The crease runs along y while the belt carries it along x.
  const auto driftSigma_mm = [](Eigen::Index focal_length) {
    SyntheticRun run;
    auto& modes = run.evidence.spot_calibration->error_modes;
    modes.emplace_back(Eigen::Matrix<double, vision::CameraCalibration::kParameters, 1>::Zero());
    if (focal_length >= 0)
      modes.back()[focal_length] = 3.0;  // Among 10 000 px: 7 um over the crease's travel.
    const auto result = run.inspected();
    return std::ranges::find_if(result.cuts, [](const CutResult& c) { return c.entity == kCreaseLine; })
        ->drift_sigma_mm;
  };
  const double known_mm = driftSigma_mm(-1);
  EXPECT_NEAR(driftSigma_mm(1), known_mm, 0.01 * known_mm);
  EXPECT_GT(driftSigma_mm(0), 2.0 * known_mm);
}

TEST(StillnessCheck, ARoughMotionIsKnownLessWell) {
  SyntheticRun run;
  const auto sigmaOf = [&](int unit) {
    for (const CutResult& cut : run.inspected().cuts) {
      if (cut.unit == unit && cut.entity == kCreaseLine) return cut.drift_sigma_mm;
    }
    return std::nan("");
  };
  run.shiftSpot(1, kCreaseLine,
                [](double t_s) { return Eigen::Vector2d(0.02 * std::sin(t_s * 2900.0), 0.0); });
  EXPECT_GT(sigmaOf(1), 2.0 * sigmaOf(0));
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

TEST(RepeatCheck, CountsFewFramesOfALineInFull) {
  // Half a step before the first of them and half a step after the last belong to the line.
  SyntheticRun run;
  std::vector<vision::FrameMeasurement> few;
  for (std::size_t i = 0; i < run.evidence.spot.frames.size(); i += 10) {
    few.push_back(run.evidence.spot.frames[i]);
    few.back().sequence = few.size() - 1;
  }
  run.evidence.spot.frames = few;
  for (const EntityResult& e : run.inspected().entities) {
    if (e.entity != kCreaseLine) continue;
    EXPECT_NEAR(e.passes, 1.0, 0.05);
  }
}

TEST(SpotPathCheck, NamesTheLineThatTheSpotIsFarthestFrom) {
  SyntheticRun run;
  run.shiftSpot(0, kTop,
                [](double t_s) { return Eigen::Vector2d(0.0, t_s > 0.05 && t_s < 0.06 ? 0.2 : 0.0); });
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "spot_path").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "spot_path").subject, "unit 0, E2");
}

TEST(LaserGateCheck, LightWithoutGateFails) {
  SyntheticRun run;
  for (GateInterval& gate : run.evidence.gates) gate.off_s -= 0.005;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "laser_gate").verdict, Verdict::kFail);
  EXPECT_NEAR(checkOf(result, "laser_gate").value, 5.0, 0.01);
  EXPECT_NEAR(checkOf(result, "laser_gate").limit, 1e3 * run.limits.gate_tail_s, 1e-9);
  run.evidence.gates.clear();
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kInvalid);
}

TEST(LaserGateCheck, LightMayLastUntilTheNextFrame) {
  // The last frame with light lies half a period before its end, and so 1.9 ms after the gate's.
  SyntheticRun run;
  for (GateInterval& gate : run.evidence.gates) gate.off_s -= 0.0024;
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kNotProven);
  for (GateInterval& gate : run.evidence.gates) gate.off_s += 0.0014;
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kPass);
}

TEST(LaserGateCheck, AFrameInWhichTheGateWasOpenShowsNoLightOutside) {
  // The last frame of a cut is exposed for 3 ms about its middle, 0.9 ms after the gate's end.
  SyntheticRun run;
  for (GateInterval& gate : run.evidence.gates) gate.off_s -= 0.0014;
  EXPECT_NEAR(checkOf(run.inspected(), "laser_gate").value, 0.9 + 0.5, 0.01);
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.exposure_s = 0.003;
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").value, 0.0);
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.exposure_s = 0.0017;
  EXPECT_NEAR(checkOf(run.inspected(), "laser_gate").value, 0.9 + 0.5, 0.01);
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
  EXPECT_THAT(check.explanation, HasSubstr("37 break"));
  EXPECT_THAT(check.explanation, HasSubstr(fmt::format("Of {} pulses", run.evidence.pulses[0].pulses +
                                                                           run.evidence.pulses[1].pulses)));
  EXPECT_NE(check.explanation.find("DIR set-up of galvo_y: 0.125 us"), std::string::npos)
      << check.explanation;
}

TEST(PulseTimingCheck, AnAxisThatNeverTurnedHasNoSetUpTime) {
  SyntheticRun run;
  run.evidence.pulses[0].min_setup_s = run.evidence.pulses[0].min_hold_s =
      std::numeric_limits<double>::infinity();
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kPass);
}

TEST(PulseTimingCheck, PulsesWhileADriveIsDisabledFailAndNameAxisAndKey) {
  SyntheticRun run;
  run.evidence.pulses[1].has_enable = true;
  run.evidence.pulses[1].profile.enable_low = true;
  run.evidence.pulses[1].disabled_pulses = 12;
  const Check check = checkOf(run.inspected(), "pulse_timing");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_THAT(check.explanation, HasSubstr(run.evidence.pulses[1].axis +
                                           ": 12 pulses while the drive was disabled; it is enabled "
                                           "while its enable line is low (`" +
                                           run.evidence.pulses[1].axis + ".enable_low`)"));
  // A guard band of stamps argues no pulse away.
  run.evidence.pin_u_s = 1e-6;
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kFail);
}

TEST(PulseTimingCheck, APulseTooSoonAfterTheEnableFails) {
  SyntheticRun run;
  PulseTiming& timing = run.evidence.pulses[0];
  timing.has_enable = true;
  timing.profile.enable_setup_s = 200e-3;
  timing.min_enable_setup_s = 1e-3;
  timing.enable_setup_violations = 1;
  const Check check = checkOf(run.inspected(), "pulse_timing");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_THAT(check.explanation, HasSubstr("time from enable to DIR or PUL"));
}

TEST(PulseTimingCheck, WithoutAnyPulseIsInvalid) {
  SyntheticRun run;
  for (PulseTiming& t : run.evidence.pulses) t.pulses = 0;
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kInvalid);
}

TEST(PulseTimingCheck, APulseThatNeverEndedTellsNoTime) {
  SyntheticRun run;
  for (PulseTiming& t : run.evidence.pulses) {
    t.pulses = 1;
    t.min_setup_s = t.min_hold_s = t.min_width_s = t.min_space_s = std::numeric_limits<double>::infinity();
  }
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "pulse_timing").verdict, Verdict::kInvalid);
  EXPECT_EQ(checkOf(result, "pulse_timing").subject, "");
}

TEST(LaserGateCheck, LightBeforeTheGateFails) {
  SyntheticRun run;
  for (GateInterval& gate : run.evidence.gates) gate.on_s += 0.005;
  EXPECT_EQ(checkOf(run.inspected(), "laser_gate").verdict, Verdict::kFail);
}

TEST(PulseTimingCheck, EachTimeIsHeldAgainstItsOwnLine) {
  // The values exceed the requirements a little, with every time of another size: no margin may be negative.
  SyntheticRun run;
  for (PulseTiming& t : run.evidence.pulses) {
    t.profile.setup_s = 20e-6;
    t.profile.hold_s = 3e-6;
    t.profile.width_s = 2e-6;
    t.profile.space_s = 8e-6;
    t.min_setup_s = 21e-6;
    t.min_hold_s = 4e-6;
    t.min_width_s = 3e-6;
    t.min_space_s = 9e-6;
  }
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "pulse_timing").verdict, Verdict::kPass);
  EXPECT_NEAR(checkOf(result, "pulse_timing").value, 1.0, 1e-9);
}

TEST(PulseTimingCheck, ATimeIsTheDifferenceOfTwoEdges) {
  SyntheticRun run;
  run.evidence.pin_u_s = 0.2e-6;
  // Two edges are each known to 0.2 us, sampled 4000 times: U is twice the scatter of their difference.
  const CounterRandom random(9, 1);
  double squares = 0.0;
  for (std::uint64_t i = 0; i < 4000; ++i)
    squares += std::pow(0.2 * (random.normal(2 * i) - random.normal(2 * i + 1)), 2) / 4000.0;
  EXPECT_NEAR(checkOf(run.inspected(), "pulse_timing").u, 2.0 * std::sqrt(squares), 0.03);
}

TEST(PulseTimingCheck, ARealStampErrorOpensAGuardBand) {
  SyntheticRun run;
  run.evidence.pin_u_s = 1e-6;
  EXPECT_EQ(checkOf(run.inspected(), "pulse_timing").verdict, Verdict::kNotProven);
}

}  // namespace
}  // namespace kerfbench::inspect

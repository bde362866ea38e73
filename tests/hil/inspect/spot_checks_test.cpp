// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/spot_association.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
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

TEST(FollowDieline, KeepsTheLineWhereItCrossesAnother) {
  SyntheticRun run;
  run.dieline.entities[kNote] = {kNote, dieline::LineCurve{{20, 10.13}, {40, 10.13}},
                                 dieline::Process::kIgnore, "", ""};
  run.dieline.entities[kNote].process = dieline::Process::kCut;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  for (const LitFrame& frame : lit.frames) EXPECT_NE(frame.entity, kNote) << frame.time_s;
}

TEST(FollowDieline, KeepsTheLineWhereANeighbourIsNowAndThenNearer) {
  // Two lines 0.2 mm apart; the spot runs between them, from frame to frame a little nearer to the one and
  // the other.
  SyntheticRun run;
  run.dieline.entities[kNote] = {kNote, dieline::LineCurve{{0, 0.2}, {60, 0.2}}, dieline::Process::kCut, "",
                                 ""};
  int odd = 0;
  run.shiftSpot(0, kBottom, [&](double) { return Eigen::Vector2d(0.0, ++odd % 2 == 0 ? 0.11 : 0.09); });
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  std::size_t followed = 0;
  for (std::size_t i = 1; i < lit.frames.size(); ++i) {
    const LitFrame& frame = lit.frames[i];
    if (frame.unit != 0 || frame.p_S_mm.y() > 0.15 || frame.p_S_mm.x() < 1.0 || frame.p_S_mm.x() > 59.0)
      continue;
    ++followed;
    EXPECT_EQ(frame.entity, lit.frames[i - 1].entity) << frame.p_S_mm.x();
  }
  EXPECT_GT(followed, 150U);
}

TEST(FollowDieline, ASheetThatLiesAskewMakesNoDifference) {
  // The whole web is turned about the machine's origin, with the spot on it. The printed line across the belt
  // keeps its deviations; its deviations along x are another matter.
  SyntheticRun run;
  const LitFrames straight = followDieline(run.evidence.spot, run.dieline);
  const Eigen::Rotation2Dd turn(0.02);
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (frame.spot_W_mm) frame.spot_W_mm = turn * *frame.spot_W_mm;
    for (vision::SheetPose& pose : frame.sheet) {
      pose.p_WS_mm = turn * pose.p_WS_mm;
      pose.angle_rad += turn.angle();
    }
  }
  const LitFrames askew = followDieline(run.evidence.spot, run.dieline);
  ASSERT_EQ(askew.frames.size(), straight.frames.size());
  for (std::size_t i = 0; i < askew.frames.size(); ++i) {
    EXPECT_EQ(askew.frames[i].entity, straight.frames[i].entity);
    EXPECT_NEAR(askew.frames[i].deviation_mm, straight.frames[i].deviation_mm, 1e-9);
    if (askew.frames[i].entity == kCreaseLine) {
      EXPECT_NEAR(std::abs(askew.frames[i].n_x), std::cos(0.02), 1e-9);
    }
  }
}

TEST(FollowDieline, TheSheetMovesEvenlyBetweenFramesThatShowIt) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  const auto before = followDieline(run.evidence.spot, run.dieline).frames;
  // Two or more frames without marks lie between two with: in each the belt has come 0.2 mm farther.
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % 6 != 0 && i % 6 != 4) frames[i].sheet.clear();
  }
  const auto after = followDieline(run.evidence.spot, run.dieline).frames;
  ASSERT_GE(after.size() + 6, before.size());
  for (const LitFrame& frame : after) {
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const LitFrame& other) { return other.frame == frame.frame; });
    ASSERT_NE(same, before.end());
    EXPECT_LT((frame.p_S_mm - same->p_S_mm).norm(), 1e-9) << frame.time_s;
  }
}

TEST(FollowDieline, ASheetThatGathersSpeedLiesBetweenTheFramesBesideIt) {
  dieline::Dieline dieline;
  dieline.entities.push_back(
      {0, dieline::LineCurve{{0.0, 0.0}, {30.0, 0.0}}, dieline::Process::kCut, "CUT", ""});
  vision::SpotTrack track;
  for (std::size_t i = 0; i <= 8; ++i) {
    vision::FrameMeasurement& frame = track.frames.emplace_back();
    frame.sequence = i;
    frame.mid_s = 1e-3 * static_cast<double>(i);
    frame.spot_W_mm = Eigen::Vector2d(20.0, 0.0);
    frame.spot_sigma_mm = 0.002;
    const double fours = 0.25 * static_cast<double>(i);
    if (i % 4 == 0) frame.sheet.push_back({0, {fours * fours, 0.0}, 0.0, 0.001, 4});
  }
  const auto frames = followDieline(track, dieline).frames;
  ASSERT_EQ(frames.size(), 9U);
  EXPECT_NEAR(frames[2].p_S_mm.x(), 20.0 - 0.5, 1e-9);
  EXPECT_NEAR(frames[6].p_S_mm.x(), 20.0 - 2.5, 1e-9);
}

TEST(FollowDieline, TheFirstFrameToldWhereTheSheetIs) {
  SyntheticRun run;
  vision::FrameMeasurement& first = run.evidence.spot.frames.front();
  first.spot_W_mm = first.sheet.front().p_WS_mm + Eigen::Vector2d(10.0, 0.0);
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  EXPECT_EQ(lit.unplaced, 0U);
  EXPECT_EQ(lit.frames.front().frame, 0U);
  EXPECT_EQ(lit.frames.front().entity, kBottom);
}

TEST(FollowDieline, BetweenTwoLinesASpotHasLeftNeither) {
  // From one line straight over to the other, whichever of them was drawn first.
  for (const double first_y_mm : {0.0, 5.0}) {
    dieline::Dieline dieline;
    for (const double y_mm : {first_y_mm, 5.0 - first_y_mm}) {
      const int id = static_cast<int>(dieline.entities.size());
      dieline.entities.push_back(
          {id, dieline::LineCurve{{0, y_mm}, {10, y_mm}}, dieline::Process::kCut, "CUT", ""});
    }
    vision::SpotTrack track;
    for (double way_mm = 0.0; way_mm < 13.0; way_mm += 0.25) {
      vision::FrameMeasurement& frame = track.frames.emplace_back();
      frame.sequence = track.frames.size() - 1;
      frame.mid_s = 1e-3 * static_cast<double>(frame.sequence);
      frame.sheet.push_back({0, {0.0, 0.0}, 0.0, 0.001, 4});
      const double y_mm = std::clamp(way_mm - 4.0, 0.0, 5.0);
      frame.spot_W_mm = Eigen::Vector2d(1.0 + way_mm - y_mm, y_mm);
      frame.spot_sigma_mm = 0.002;
    }
    int between = 0;
    for (const LitFrame& frame : followDieline(track, dieline).frames) {
      if (frame.entity >= 0) continue;
      ++between;
      EXPECT_EQ(frame.left_entity, -1) << frame.p_S_mm.transpose();
    }
    EXPECT_GT(between, 10);
  }
}

TEST(FollowDieline, ASpotThatRunsOnBeyondTheEndOfItsLineIsMeasuredAgainstNone) {
  dieline::Dieline dieline;
  dieline.entities.push_back(
      {0, dieline::LineCurve{{0.0, 0.0}, {10.0, 0.0}}, dieline::Process::kCut, "CUT", ""});
  vision::SpotTrack track;
  for (double x_mm = 1.0; x_mm < 13.0; x_mm += 0.25) {
    vision::FrameMeasurement& frame = track.frames.emplace_back();
    frame.sequence = track.frames.size() - 1;
    frame.mid_s = 1e-3 * static_cast<double>(frame.sequence);
    frame.sheet.push_back({0, {0.0, 0.0}, 0.0, 0.001, 4});
    frame.spot_W_mm = Eigen::Vector2d(x_mm, 0.0);
    frame.spot_sigma_mm = 0.002;
  }
  int beyond = 0;
  for (const LitFrame& frame : followDieline(track, dieline).frames) {
    if (frame.p_S_mm.x() < 11.0) continue;
    ++beyond;
    EXPECT_EQ(frame.entity, -1);
    EXPECT_EQ(frame.left_entity, -1) << frame.p_S_mm.x();
  }
  EXPECT_GT(beyond, 5);
}

TEST(FollowDieline, ATurnOfTheSheetMovesASpotByItsDistanceFromThePivot) {
  constexpr double kTurn_rad = 1e-4;
  const Eigen::Vector2d pivot_mm(60.0, 40.0);
  SyntheticRun run;
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    for (vision::SheetPose& pose : frame.sheet) {
      const Eigen::Vector3d turn(pivot_mm.y(), -pivot_mm.x(), 1.0);
      pose.covariance = kTurn_rad * kTurn_rad * turn * turn.transpose();
    }
  }
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline).frames) {
    const vision::FrameMeasurement& seen = run.evidence.spot.frames[frame.frame];
    if (seen.sheet.empty()) continue;  // Between two poses, which are known better together.
    const double away_mm = (frame.p_S_mm - pivot_mm).norm();
    EXPECT_NEAR(frame.sigma_mm, std::hypot(seen.spot_sigma_mm, kTurn_rad * away_mm / std::numbers::sqrt2),
                1e-6)
        << frame.p_S_mm.transpose();
  }
}

TEST(FollowDieline, AtACornerNobodyKnowsWhichLineItIs) {
  const SyntheticRun run;
  int corners = 0;
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline).frames) {
    if (frame.entity != kBottom && frame.entity != kTop) continue;
    const double from_corner_mm = std::min(frame.p_S_mm.x(), 60.0 - frame.p_S_mm.x());
    if (from_corner_mm < 0.25) {
      EXPECT_TRUE(frame.ambiguous) << frame.p_S_mm.transpose();
      ++corners;
    } else if (from_corner_mm > 0.35) {
      EXPECT_FALSE(frame.ambiguous) << frame.p_S_mm.transpose();
    }
  }
  EXPECT_GE(corners, 8);
}

TEST(FollowDieline, EachTimeTheBeamSetsOutItBeginsARun) {
  const SyntheticRun run;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  EXPECT_EQ(lit.runs.size(), run.evidence.gates.size() - 2 * 3) << "the outline is one run of four lines";
  for (const LitRun& one : lit.runs) {
    for (std::size_t i = one.begin + 1; i < one.end; ++i)
      EXPECT_EQ(lit.frames[i].frame, lit.frames[i - 1].frame + 1);
  }
}

TEST(FollowDieline, WhereNoMarkWasSeenForLongNobodyKnowsTheSheet) {
  SyntheticRun run;
  const auto& gate = run.evidence.gates[2];
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (std::abs(frame.mid_s - gate.on_s) < 0.15) frame.sheet.clear();
  }
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline);
  EXPECT_GT(lit.unplaced, 50U);
  for (const LitFrame& frame : lit.frames) EXPECT_GT(std::abs(frame.time_s - gate.on_s), 0.14);
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
  EXPECT_THAT(checkOf(result, "stillness_x").subject, ::testing::HasSubstr("along no drawn line at x"));
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

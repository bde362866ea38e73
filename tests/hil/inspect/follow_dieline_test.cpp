// SPDX-License-Identifier: Apache-2.0
// Which line each spot follows, and where the sheet lies meanwhile.
#include "hil/inspect/evidence/spot_association.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

void addCut(dieline::Dieline& dieline, const dieline::Curve& curve) {
  const int id = static_cast<int>(dieline.entities.size());
  dieline.entities.push_back({id, curve, dieline::Process::kCut, "CUT", ""});
}

/// A frame in each millisecond, with the spot there; the sheet is not placed yet.
vision::FrameMeasurement& addFrame(vision::SpotTrack& track, const Eigen::Vector2d& spot_W_mm) {
  vision::FrameMeasurement& frame = track.frames.emplace_back();
  frame.sequence = track.frames.size() - 1;
  frame.mid_s = 1e-3 * static_cast<double>(frame.sequence);
  frame.spot_W_mm = spot_W_mm;
  frame.spot_sigma_mm = 0.002;
  return frame;
}

TEST(FollowDieline, PutsEverySpotOnTheEntityThatItFollows) {
  SyntheticRun run;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
  EXPECT_EQ(lit.unplaced, 0U);
  EXPECT_EQ(lit.frames.size(), lit.lit);
  for (const LitFrame& frame : lit.frames) {
    EXPECT_GE(frame.entity, 0) << frame.time_s;
    EXPECT_LT(std::abs(frame.deviation_mm), 0.015);
  }
}

TEST(FollowDieline, KeepsTheLineWhereItCrossesAnother) {
  SyntheticRun run;
  run.dieline.entities[kNote] = {kNote, dieline::LineCurve{{20, 10.13}, {40, 10.13}},
                                 dieline::Process::kIgnore, "", ""};
  run.dieline.entities[kNote].process = dieline::Process::kCut;
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
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
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
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
  const LitFrames straight = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
  const Eigen::Rotation2Dd turn(0.02);
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (frame.spot_W_mm) frame.spot_W_mm = turn * *frame.spot_W_mm;
    for (vision::SheetPose& pose : frame.sheet) {
      pose.p_WS_mm = turn * pose.p_WS_mm;
      pose.angle_rad += turn.angle();
    }
  }
  const LitFrames askew = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
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
  const auto before = followDieline(run.evidence.spot, run.dieline, run.evidence.gates).frames;
  // Two or more frames without marks lie between two with: in each the belt has come 0.2 mm farther.
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % 6 != 0 && i % 6 != 4) frames[i].sheet.clear();
  }
  const auto after = followDieline(run.evidence.spot, run.dieline, run.evidence.gates).frames;
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
  addCut(dieline, dieline::LineCurve{{0.0, 0.0}, {30.0, 0.0}});
  vision::SpotTrack track;
  for (std::size_t i = 0; i <= 8; ++i) {
    vision::FrameMeasurement& frame = addFrame(track, {20.0, 0.0});
    const double fours = 0.25 * static_cast<double>(i);
    if (i % 4 == 0) frame.sheet.push_back({0, {fours * fours, 0.0}, 0.0, 0.001, 4});
  }
  const auto frames = followDieline(track, dieline, {}).frames;
  ASSERT_EQ(frames.size(), 9U);
  EXPECT_NEAR(frames[2].p_S_mm.x(), 20.0 - 0.5, 1e-9);
  EXPECT_NEAR(frames[6].p_S_mm.x(), 20.0 - 2.5, 1e-9);
}

TEST(FollowDieline, TheFirstFrameToldWhereTheSheetIs) {
  SyntheticRun run;
  vision::FrameMeasurement& first = run.evidence.spot.frames.front();
  first.spot_W_mm = first.sheet.front().p_WS_mm + Eigen::Vector2d(10.0, 0.0);
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
  EXPECT_EQ(lit.unplaced, 0U);
  EXPECT_EQ(lit.frames.front().frame, 0U);
  EXPECT_EQ(lit.frames.front().entity, kBottom);
}

TEST(FollowDieline, BetweenTwoLinesASpotHasLeftNeither) {
  // From one line straight over to the other, whichever of them was drawn first.
  for (const double first_y_mm : {0.0, 5.0}) {
    dieline::Dieline dieline;
    for (const double y_mm : {first_y_mm, 5.0 - first_y_mm})
      addCut(dieline, dieline::LineCurve{{0, y_mm}, {10, y_mm}});
    vision::SpotTrack track;
    for (double way_mm = 0.0; way_mm < 13.0; way_mm += 0.25) {
      const double y_mm = std::clamp(way_mm - 4.0, 0.0, 5.0);
      addFrame(track, {1.0 + way_mm - y_mm, y_mm}).sheet.push_back({0, {0.0, 0.0}, 0.0, 0.001, 4});
    }
    int between = 0;
    for (const LitFrame& frame : followDieline(track, dieline, {}).frames) {
      if (frame.entity >= 0) continue;
      ++between;
      EXPECT_EQ(frame.left_entity, -1) << frame.p_S_mm.transpose();
    }
    EXPECT_GT(between, 10);
  }
}

TEST(FollowDieline, ASpotThatRunsOnBeyondTheEndOfItsLineIsMeasuredAgainstNone) {
  dieline::Dieline dieline;
  addCut(dieline, dieline::LineCurve{{0.0, 0.0}, {10.0, 0.0}});
  vision::SpotTrack track;
  for (double x_mm = 1.0; x_mm < 13.0; x_mm += 0.25)
    addFrame(track, {x_mm, 0.0}).sheet.push_back({0, {0.0, 0.0}, 0.0, 0.001, 4});
  int beyond = 0;
  for (const LitFrame& frame : followDieline(track, dieline, {}).frames) {
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
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline, run.evidence.gates).frames) {
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
  for (const LitFrame& frame : followDieline(run.evidence.spot, run.dieline, run.evidence.gates).frames) {
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
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
  EXPECT_EQ(lit.runs.size(), run.evidence.gates.size() - 2 * 3) << "the outline is one run of four lines";
  for (const LitRun& one : lit.runs) {
    for (std::size_t i = one.begin + 1; i < one.end; ++i)
      EXPECT_EQ(lit.frames[i].frame, lit.frames[i - 1].frame + 1);
  }
}

TEST(FollowDieline, DarkFramesDoNotEndACutWhileTheGateIsOpen) {
  SyntheticRun run;
  const std::size_t cuts = followDieline(run.evidence.spot, run.dieline, run.evidence.gates).runs.size();
  std::vector<vision::FrameMeasurement>& frames = run.evidence.spot.frames;
  std::size_t darkened = 0;
  for (std::size_t i = 17; i + 1 < frames.size(); i += 17) {
    const bool in_a_cut = std::ranges::any_of(run.evidence.gates, [&](const GateInterval& gate) {
      return gate.on_s <= frames[i - 4].mid_s && frames[i + 1].mid_s <= gate.off_s;
    });
    if (!in_a_cut || !frames[i - 1].spot_W_mm || !frames[i].spot_W_mm || !frames[i + 1].spot_W_mm) continue;
    frames[i].spot_W_mm.reset();
    ++darkened;
  }
  ASSERT_GT(darkened, 20U);
  EXPECT_EQ(followDieline(run.evidence.spot, run.dieline, run.evidence.gates).runs.size(), cuts);
  EXPECT_EQ(followDieline(run.evidence.spot, run.dieline, {}).runs.size(), cuts + darkened)
      << "nothing says that the gate was open meanwhile";
}

TEST(FollowDieline, AJumpWithoutLightEndsACutThoughTheGateStaysOpen) {
  SyntheticRun run;
  const double faster = 0.9;
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.mid_s *= faster;
  for (GateInterval& gate : run.evidence.gates) gate = {faster * gate.on_s, faster * gate.off_s};
  run.evidence.light.clear();
  for (const GateInterval& gate : run.evidence.gates) run.evidence.light.push_back({gate.on_s, gate.off_s});
  // The gate stays open all the time, and its PWM line keeps the laser dark in the jumps, for 19 ms each.
  run.evidence.gates = {{run.evidence.gates.front().on_s, run.evidence.gates.back().off_s}};
  const InspectionResult result = run.inspected();
  EXPECT_EQ(checkOf(result, "repeat").verdict, Verdict::kPass) << checkOf(result, "repeat").explanation;
  for (const EntityResult& entity : result.entities) EXPECT_NEAR(entity.passes, 1.0, 0.1) << entity.entity;
}

TEST(FollowDieline, WhereNoMarkWasSeenForLongNobodyKnowsTheSheet) {
  SyntheticRun run;
  const auto& gate = run.evidence.gates[2];
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (std::abs(frame.mid_s - gate.on_s) < 0.15) frame.sheet.clear();
  }
  const LitFrames lit = followDieline(run.evidence.spot, run.dieline, run.evidence.gates);
  EXPECT_GT(lit.unplaced, 50U);
  for (const LitFrame& frame : lit.frames) EXPECT_GT(std::abs(frame.time_s - gate.on_s), 0.14);
}

}  // namespace
}  // namespace kerfbench::inspect

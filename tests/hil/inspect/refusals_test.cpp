// SPDX-License-Identifier: Apache-2.0
// Refused or INVALID, never PASS. Where each reason is found in the pictures, and here: that the verdict
// heeds it. The tests of dark frames are in spot_seen_test.cpp.
//
// clang-format off
//   reason                      spot camera                               kerf camera
//   dark                        SpotRefusal.DarkFrames                    KerfRefusal.DarkPictures
//   saturated                   SpotRefusal.SaturatedFrames               KerfRefusal.SaturatedPictures
//   blurred                     SpotRefusal.BlurredFrames                 KerfRefusal.BlurredPictures
//   empty                       SpotRefusal.FramesThatNoSensorTook,       KerfRefusal.EmptyPictures,
//                               SpotRefusal.OneBadFrameIsEnough           KerfRefusal.NoPictureAtAll
//   no spot, gate open          Refusals.DarkFramesWithinACut…            (coverage)
//   wrong camera size           SpotRefusal.FramesOfAnotherSize,          KerfRefusal.PicturesOfAnotherSize,
//                               CameraFiles.OneOfAnotherCameraIsAProblem  CameraFiles.OneOfAnotherCameraIsAProblem
//   another's calibration       Calibration.OfAnotherCameraMakesARunInvalid (both), CameraFiles
//   board outside the field     Refusals below (area), SpotRefusal        KerfRefusal.ABoardBesideTheField
//   marks missing or moved      SpotRefusal.MarksThatAreMissing, …Moved   KerfRefusal.MarksThatAreMissingOrMoved
//   frames dropped around a cut Refusals.AFrameLost…, RefusedRuns         (a tile that is missing: no tile)
//   late frames                 Refusals.ALateStamp…, RefusedRuns         –
//   sheet and encoder part      Belt.…                                    –
//   NaN                         Refusals.NoFieldMayBeNoNumber             the same
//   no cut at all               Refusals, RefusedRuns                     coverage: FAIL
// clang-format on
#include <algorithm>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hil/inspect/not_numbers.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

bool tells(const InspectionResult& result, const std::string& word) {
  return std::any_of(result.problems.begin(), result.problems.end(),
                     [&](const std::string& p) { return p.find(word) != std::string::npos; });
}

/// The first frame with a spot in a pose with marks, past its cut's first tenth of a second.
vision::FrameMeasurement& litFrame(SyntheticRun& run) {
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    if (frame.mid_s > 0.1 && frame.spot_W_mm && !frame.sheet.empty()) return frame;
  }
  throw std::logic_error("no frame is lit");
}
vision::Caliper& caliper(SyntheticRun& run) { return run.kerf(0, kTop).calipers[50]; }
void lose(SyntheticRun& run, std::size_t first, std::size_t count) {
  auto& frames = run.evidence.spot.frames;
  const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(first);
  frames.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
  run.evidence.spot.frames_lost += count;
}

struct Field {
  const char* name;
  std::function<double&(SyntheticRun&)> of;
  bool may_be_infinite{false};  ///< A time of which nothing was seen.
};

const std::vector<Field>& fields() {
  using Run = SyntheticRun;
  static const std::vector<Field> all{
      {"frame.mid_s", [](Run& r) -> double& { return litFrame(r).mid_s; }},
      {"spot x", [](Run& r) -> double& { return litFrame(r).spot_W_mm->x(); }},
      {"spot y", [](Run& r) -> double& { return litFrame(r).spot_W_mm->y(); }},
      {"spot_sigma", [](Run& r) -> double& { return litFrame(r).spot_sigma_mm; }},
      {"sheet x", [](Run& r) -> double& { return litFrame(r).sheet[0].p_WS_mm.x(); }},
      {"sheet y", [](Run& r) -> double& { return litFrame(r).sheet[0].p_WS_mm.y(); }},
      {"sheet angle", [](Run& r) -> double& { return litFrame(r).sheet[0].angle_rad; }},
      {"sheet residual", [](Run& r) -> double& { return litFrame(r).sheet[0].residual_mm; }},
      {"sheet covariance", [](Run& r) -> double& { return litFrame(r).sheet[0].covariance(0, 0); }},
      {"sheet covariance xy", [](Run& r) -> double& { return litFrame(r).sheet[0].covariance(1, 2); }},
      {"caliper u", [](Run& r) -> double& { return caliper(r).u; }},
      {"caliper station", [](Run& r) -> double& { return caliper(r).station_mm; }},
      {"caliper p_S", [](Run& r) -> double& { return caliper(r).p_S_mm.y(); }},
      {"caliper p_V", [](Run& r) -> double& { return caliper(r).p_V_mm.x(); }},
      {"caliper offset", [](Run& r) -> double& { return caliper(r).offset_mm; }},
      {"caliper sigma", [](Run& r) -> double& { return caliper(r).sigma_mm; }},
      {"caliper steady sigma", [](Run& r) -> double& { return caliper(r).steady_sigma_mm; }},
      {"caliper width", [](Run& r) -> double& { return caliper(r).width_mm; }},
      {"caliper width sigma", [](Run& r) -> double& { return caliper(r).width_sigma_mm; }},
      {"caliper brightness", [](Run& r) -> double& { return caliper(r).brightness; }},
      {"corner deviation", [](Run& r) -> double& { return r.evidence.kerf.corners[0].deviation_mm; }},
      {"corner rounding", [](Run& r) -> double& { return r.evidence.kerf.corners[0].rounding_mm; }},
      {"corner overshoot", [](Run& r) -> double& { return r.evidence.kerf.corners[0].overshoot_mm; }},
      {"corner deviation sigma",
       [](Run& r) -> double& { return r.evidence.kerf.corners[0].deviation_sigma_mm; }},
      {"corner rounding sigma",
       [](Run& r) -> double& { return r.evidence.kerf.corners[0].rounding_sigma_mm; }},
      {"corner overshoot sigma",
       [](Run& r) -> double& { return r.evidence.kerf.corners[0].overshoot_sigma_mm; }},
      {"corner place", [](Run& r) -> double& { return r.evidence.kerf.corners[0].p_S_mm.x(); }},
      {"corner turn", [](Run& r) -> double& { return r.evidence.kerf.corners[0].turn_rad; }},
      {"end gap", [](Run& r) -> double& { return r.evidence.kerf.ends[0].gap_mm; }},
      {"end sigma", [](Run& r) -> double& { return r.evidence.kerf.ends[0].sigma_mm; }},
      {"unit x", [](Run& r) -> double& { return r.evidence.kerf.units[0].p_TS_mm.x(); }},
      {"unit angle", [](Run& r) -> double& { return r.evidence.kerf.units[1].angle_rad; }},
      {"unit covariance", [](Run& r) -> double& { return r.evidence.kerf.units[1].covariance(2, 2); }},
      {"unit residual", [](Run& r) -> double& { return r.evidence.kerf.units[0].residual_mm; }},
      {"mark residual", [](Run& r) -> double& { return r.evidence.kerf.mark_residual_mm; }},
      {"stray extent", [](Run& r) -> double& { return r.evidence.kerf.strays[0].extent_mm; }},
      {"stray place", [](Run& r) -> double& { return r.evidence.kerf.strays[0].p_S_mm.x(); }},
      {"set-up", [](Run& r) -> double& { return r.evidence.pulses[0].min_setup_s; }, true},
      {"hold", [](Run& r) -> double& { return r.evidence.pulses[1].min_hold_s; }, true},
      {"width", [](Run& r) -> double& { return r.evidence.pulses[0].min_width_s; }, true},
      {"space", [](Run& r) -> double& { return r.evidence.pulses[0].min_space_s; }, true},
      {"set-up asked", [](Run& r) -> double& { return r.evidence.pulses[0].profile.setup_s; }},
      {"hold asked", [](Run& r) -> double& { return r.evidence.pulses[0].profile.hold_s; }},
      {"first violation", [](Run& r) -> double& { return r.evidence.pulses[0].first_violation_s; }},
      {"gate on", [](Run& r) -> double& { return r.evidence.gates[1].on_s; }},
      {"gate off", [](Run& r) -> double& { return r.evidence.gates[1].off_s; }},
      {"belt time", [](Run& r) -> double& { return r.evidence.belt[700].time_s; }},
      {"belt place", [](Run& r) -> double& { return r.evidence.belt[700].x_mm; }},
      {"belt count", [](Run& r) -> double& { return r.evidence.belt_count_mm; }},
      {"power edge", [](Run& r) -> double& { return r.evidence.power_edges_s[1]; }},
      {"power quantum", [](Run& r) -> double& { return r.evidence.power_quantum_j; }},
      {"pin_u", [](Run& r) -> double& { return r.evidence.pin_u_s; }},
      {"spot fx", [](Run& r) -> double& { return r.evidence.spot_calibration->fx_px; }},
      {"spot map_u", [](Run& r) -> double& { return r.evidence.spot_calibration->map_u_mm; }},
      {"spot area", [](Run& r) -> double& { return r.evidence.spot_calibration->area_mm.min().x(); }},
      {"spot distortion", [](Run& r) -> double& { return r.evidence.spot_calibration->distortion[1]; }},
      {"spot pose", [](Run& r) -> double& { return r.evidence.spot_calibration->X_CP.translation().z(); }},
      {"kerf fy", [](Run& r) -> double& { return r.evidence.kerf_calibration->fy_px; }},
      {"kerf map_u", [](Run& r) -> double& { return r.evidence.kerf_calibration->map_u_mm; }},
      {"kerf area", [](Run& r) -> double& { return r.evidence.kerf_calibration->area_mm.max().y(); }},
      {"kerf error mode", [](Run& r) -> double& { return r.evidence.kerf_calibration->error_modes[0](0); }},
      {"kerf rms", [](Run& r) -> double& { return r.evidence.kerf_calibration->rms_px; }},
      {"print pitch", [](Run& r) -> double& { return r.evidence.print.pitch_mm; }},
      {"print mark", [](Run& r) -> double& { return r.evidence.print.marks[0].p_SM_mm.y(); }},
      {"limit path", [](Run& r) -> double& { return r.limits.path_mm; }},
      {"limit stillness", [](Run& r) -> double& { return r.limits.stillness_mm; }},
      {"limit uncut", [](Run& r) -> double& { return r.limits.uncut_mm; }},
      {"limit uncut share", [](Run& r) -> double& { return r.limits.uncut_share; }},
      {"limit cut through", [](Run& r) -> double& { return r.limits.cut_through_mm; }},
      {"limit dwell", [](Run& r) -> double& { return r.limits.dwell_mm; }},
      {"limit even depth", [](Run& r) -> double& { return r.limits.even_depth_share; }},
      {"limit board", [](Run& r) -> double& { return r.limits.board_transmission; }},
      {"limit line energy", [](Run& r) -> double& { return r.limits.line_energy_j_mm; }},
      {"limit energy share", [](Run& r) -> double& { return r.limits.line_energy_share; }},
      {"limit gate tail", [](Run& r) -> double& { return r.limits.gate_tail_s; }},
  };
  return all;
}

/// Flawless, with one of everything that evidence may hold.
SyntheticRun fullRun() {
  SyntheticRun run;
  vision::CornerKerf corner;
  corner.p_S_mm = {60.0, 0.0};
  corner.entity_in = kBottom;
  corner.entity_out = kRight;
  corner.turn_rad = 1.57;
  corner.found = true;
  corner.rounding_mm = corner.overshoot_mm = 0.002;
  corner.deviation_sigma_mm = corner.rounding_sigma_mm = corner.overshoot_sigma_mm = 0.001;
  run.evidence.kerf.corners.push_back(corner);
  run.evidence.kerf.ends.push_back({0, kCreaseLine, true, true, 0.001, 0.001});
  run.evidence.kerf.strays.push_back({0, {10.0, 10.0}, 0.1});
  run.evidence.power_edges_s = {0.1, 0.2, 0.3};
  run.evidence.power_quantum_j = 1e-3;
  for (auto* calibration : {&run.evidence.kerf_calibration, &run.evidence.spot_calibration}) {
    if ((*calibration)->error_modes.empty()) (*calibration)->error_modes.emplace_back().setZero();
  }
  return run;
}

TEST(Refusals, TheRunThatIsSpoiltPasses) { EXPECT_EQ(fullRun().inspected().verdict, Verdict::kPass); }

TEST(Refusals, NoFieldMayBeNoNumber) {
  for (const Field& field : fields()) {
    for (const double value : {kNan, kInf, -kInf}) {
      if (value == kInf && field.may_be_infinite) continue;
      SyntheticRun run = fullRun();
      field.of(run) = value;
      const InspectionResult result = run.inspected();
      EXPECT_EQ(result.verdict, Verdict::kInvalid) << field.name << " = " << value;
      EXPECT_TRUE(tells(result, "no numbers")) << field.name << " = " << value;
    }
  }
}

TEST(Refusals, WhateverACameraComplainsOfIsInvalid) {
  SyntheticRun run;
  run.evidence.spot.problems.emplace_back("24 frames of the spot camera are dark, the first is number 0.");
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  SyntheticRun other;
  other.evidence.kerf.problems.emplace_back("unit 0: the pictures of the kerf camera are blurred");
  EXPECT_EQ(other.inspected().verdict, Verdict::kInvalid);
}

TEST(Refusals, AFrameLostAroundACutIsInvalid) {
  // Within the first cut; next to its start; next to its end.
  SyntheticRun good;
  const double on_s = good.evidence.gates.front().on_s;
  const double off_s = good.evidence.gates.front().off_s;
  for (const double at_s : {on_s + 0.1, on_s - 0.0004, on_s - 0.0014, off_s + 0.0001, off_s + 0.0011}) {
    SyntheticRun run;
    lose(run, run.frameAt(at_s), 1);
    const InspectionResult result = run.inspected();
    EXPECT_EQ(result.verdict, Verdict::kInvalid) << at_s;
    EXPECT_TRUE(tells(result, "lost 1 frames around cuts")) << at_s;
  }
}

TEST(Refusals, FramesLostBetweenCutsDoNoHarm) {
  SyntheticRun run;
  // After the outline, the first four gates, the beam is dark for twenty frames.
  const double off_s = run.evidence.gates[3].off_s;
  lose(run, run.frameAt(off_s + 0.005), 8);
  const InspectionResult result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_NE(checkOf(result, "spot_seen").explanation.find("8 frames were lost between cuts"),
            std::string::npos);
}

TEST(Refusals, LossesThatTheSequenceDoesNotShowAreInvalid) {
  SyntheticRun run;
  run.evidence.spot.frames_lost = 2;
  EXPECT_TRUE(tells(run.inspected(), "lost 2 frames"));
}

TEST(Refusals, FramesOutOfOrderAreInvalid) {
  SyntheticRun run;
  std::swap(run.evidence.spot.frames[100].sequence, run.evidence.spot.frames[101].sequence);
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  EXPECT_TRUE(tells(run.inspected(), "out of order"));
}

TEST(Refusals, ALateStampIsFoundByTheSequenceAndAnEarlyOneToo) {
  for (const double off_s : {0.0008, -0.0008}) {
    SyntheticRun run;
    run.evidence.spot.frames[100].mid_s += off_s;
    const InspectionResult result = run.inspected();
    EXPECT_EQ(result.verdict, Verdict::kInvalid);
    EXPECT_TRUE(tells(result, "do not fit the numbers of its frames, first at number 100")) << off_s;
  }
}

TEST(Refusals, TheFirstFramesStampIsFoundByTheNextFrame) {
  SyntheticRun run;
  run.evidence.spot.frames[0].mid_s -= 0.0008;
  EXPECT_TRUE(tells(run.inspected(), "do not fit the numbers of its frames, first at number 1"));
}

TEST(Refusals, AStampThatIsLateWithAllThatFollowIsFoundByTheSheet) {
  // Half a frame, and so within what the sequence allows: the sheet is 0.09 mm off, and more with 0.24 m/s.
  SyntheticRun run;
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) {
    for (vision::SheetPose& pose : frame.sheet) pose.p_WS_mm.x() *= 3.0;
    if (frame.spot_W_mm) frame.spot_W_mm->x() += 400.0 * frame.mid_s;
  }
  run.evidence.spot.frames[100].mid_s += 0.00045;
  EXPECT_TRUE(tells(run.inspected(), "does not lie where the frames before and after have it"));
}

TEST(Refusals, ASheetThatJumpsIsInvalid) {
  SyntheticRun run;
  run.evidence.spot.frames[100].sheet[0].p_WS_mm.x() += 0.2;
  EXPECT_TRUE(tells(run.inspected(), "does not lie where the frames before and after have it"));
}

TEST(Refusals, ASheetMayJumpByTheNoiseOfThreePoses) {
  // Each pose is known to 0.05 mm: of three, six standard deviations are 0.52 mm, and 0.1 mm are always
  // allowed.
  SyntheticRun run;
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames)
    for (vision::SheetPose& pose : frame.sheet) pose.covariance(0, 0) = 0.05 * 0.05;
  double& x_mm = run.evidence.spot.frames[100].sheet[0].p_WS_mm.x();
  x_mm += 0.57;
  EXPECT_FALSE(tells(run.inspected(), "does not lie where the frames before and after have it"));
  x_mm += 0.10;
  EXPECT_TRUE(tells(run.inspected(), "does not lie where the frames before and after have it"));
}

TEST(Refusals, ACameraThatWatchedOnlyAPartIsInvalid) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  frames.erase(frames.begin(), frames.begin() + 100);
  EXPECT_TRUE(tells(run.inspected(), "begin after the first cut"));
  SyntheticRun other;
  other.evidence.spot.frames.resize(other.evidence.spot.frames.size() - 60);
  EXPECT_TRUE(tells(other.inspected(), "end before the last cut"));
}

TEST(Refusals, ACameraMayBeginWithinAFrameOfTheFirstCutAndEndWithinOneOfTheLast) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  frames.resize(run.frameAt(run.evidence.gates.back().off_s));
  frames.erase(frames.begin(),
               frames.begin() + static_cast<std::ptrdiff_t>(run.frameAt(run.evidence.gates.front().on_s)));
  const auto result = run.inspected();
  EXPECT_FALSE(tells(result, "begin after the first cut"));
  EXPECT_FALSE(tells(result, "end before the last cut"));
}

TEST(Refusals, ADeadLaserFailsByCoverageThoughTheSpotIsNotSeen) {
  SyntheticRun run;
  const double on_s = run.evidence.gates.front().on_s;
  for (std::size_t i = run.frameAt(on_s + 0.05); i < run.frameAt(on_s + 0.15); ++i)
    run.evidence.spot.frames[i].spot_W_mm.reset();
  for (vision::Caliper& c : run.kerf(0, kBottom).calipers) {
    c.found = false;
    c.brightness = 0.0;
    c.offset_mm = c.width_mm = c.sigma_mm = c.width_sigma_mm = kNan;
  }
  const InspectionResult result = run.inspected();
  EXPECT_EQ(checkOf(result, "spot_seen").verdict, Verdict::kInvalid);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

/// A run whose kerfs are seen 0.28 mm deep in the board, at up to 7 degrees.
SyntheticRun seenAslant(double depth_sigma_mm) {
  SyntheticRun run;
  run.evidence.kerf_calibration->X_CP.translation() = Eigen::Vector3d(0.0, 0.0, 300.0);
  double side_mm = 37.0;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    kerf.depth_mm = 0.28;
    kerf.depth_sigma_mm = depth_sigma_mm;
    for (vision::Caliper& c : kerf.calipers) c.p_V_mm = {side_mm = -side_mm, 0.0};
  }
  run.evidence.kerf_calibration->area_mm = {Eigen::Vector2d(-40.0, -40.0), Eigen::Vector2d(40.0, 40.0)};
  return run;
}

TEST(Refusals, WallsThatLeaveMoreOpenThanHalfTheLimitAreInvalid) {
  EXPECT_FALSE(tells(seenAslant(0.08).inspected(), "telecentric lens"));
  const SyntheticRun run = seenAslant(0.12);
  EXPECT_TRUE(tells(run.inspected(), "looks at the board at up to 7.0°"));
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  // A lens that is square to the sheet sees none of it.
  SyntheticRun square = seenAslant(0.12);
  square.evidence.kerf_calibration->telecentric_mm = 300.0;
  square.evidence.kerf_calibration->square_within_rad = 0.005;
  EXPECT_FALSE(tells(square.inspected(), "telecentric lens"));
  square.evidence.kerf_calibration->square_within_rad = 0.1;
  EXPECT_TRUE(tells(square.inspected(), "telecentric lens"));
}

TEST(Refusals, TilesThatDisagreeByMoreThanTheTableDoesAreInvalid) {
  SyntheticRun run;
  run.evidence.kerf.table_sigma_mm = 0.002;
  run.evidence.kerf.tile_misfit_mm = 0.0055;
  EXPECT_FALSE(tells(run.inspected(), "overlapping tiles"));
  run.evidence.kerf.tile_misfit_mm = 0.0065;
  EXPECT_TRUE(tells(run.inspected(), "overlapping tiles"));
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

TEST(Refusals, ACrossOfTheFieldsBorderIsInvalid) {
  SyntheticRun run;
  run.evidence.spot_calibration->area_mm.max().x() = 100.0;
  EXPECT_TRUE(tells(run.inspected(), "outside the area that the spot camera's"));
  SyntheticRun other;
  other.evidence.kerf_calibration->area_mm.max().x() = 0.0;
  EXPECT_TRUE(tells(other.inspected(), "outside the area that the kerf camera's"));
}

TEST(Refusals, NoCutAtAllNeverPasses) {
  SyntheticRun run;
  run.evidence.gates.clear();
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames) frame.spot_W_mm.reset();
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) {
      c.found = false;
      c.brightness = 0.0;
      c.offset_mm = c.width_mm = c.sigma_mm = c.width_sigma_mm = kNan;
    }
  }
  EXPECT_EQ(run.inspected().verdict, Verdict::kFail);
  // The app adds that the gate was never opened.
  run.evidence.problems.emplace_back("the laser gate was never opened: nothing was cut");
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

}  // namespace
}  // namespace kerfbench::inspect

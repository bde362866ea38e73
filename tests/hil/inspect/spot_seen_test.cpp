// SPDX-License-Identifier: Apache-2.0
// Refused or INVALID, never PASS: frames that should show a spot and are dark, and which of them are excused.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hil/inspect/checks/spot_checks.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

TEST(Refusals, DarkFramesWithinACutAreInvalid) {
  SyntheticRun run;
  const double on_s = run.evidence.gates.front().on_s;
  for (std::size_t i = 0; i < 3; ++i) run.evidence.spot.frames[run.frameAt(on_s + 0.1) + i].spot_W_mm.reset();
  const InspectionResult result = run.inspected();
  EXPECT_EQ(checkOf(result, "spot_seen").verdict, Verdict::kInvalid);
  EXPECT_NE(checkOf(result, "spot_seen").explanation.find("In 3 of "), std::string::npos);
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
}

TEST(Refusals, DarkFramesAmongFaintOnesAreExcused) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  const std::size_t dark = run.frameAt(run.evidence.gates.front().on_s + 0.1);
  frames[dark].spot_W_mm.reset();
  frames[dark + 1].spot_W_mm.reset();
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid);
  // The frame before them places the spot three times worse than usual: it glows faintly there.
  frames[dark - 1].spot_sigma_mm *= 3.0;
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kPass);
}

TEST(Refusals, DarkFramesBetweenPulsesOfLightAreExcused) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  const double period_s = frames[1].mid_s - frames[0].mid_s;
  for (vision::FrameMeasurement& frame : frames) frame.exposure_s = 0.2 * period_s;
  const std::size_t dark = run.frameAt(run.evidence.gates.front().on_s + 0.1);
  frames[dark].spot_W_mm.reset();
  frames[dark + 1].spot_W_mm.reset();
  // Light all along each cut, but for some periods about the two.
  const auto pulsesAround = [&](double dark_s) {
    run.evidence.light.clear();
    const double middle_s = 0.5 * (frames[dark].mid_s + frames[dark + 1].mid_s);
    for (const GateInterval& gate : run.evidence.gates) {
      if (middle_s < gate.on_s || middle_s > gate.off_s) {
        run.evidence.light.push_back({gate.on_s, gate.off_s});
        continue;
      }
      run.evidence.light.push_back({gate.on_s, middle_s - 0.5 * dark_s});
      run.evidence.light.push_back({middle_s + 0.5 * dark_s, gate.off_s});
    }
  };
  pulsesAround(0.0);
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid) << "the laser emitted";
  pulsesAround(1.5 * period_s);
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kPass);
  pulsesAround(8.0 * period_s);
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid) << "a gate without light";
  pulsesAround(1.5 * period_s);
  run.evidence.clock_bound_s = period_s;
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid) << "nobody knows which frames";
}

/// A PWM whose pulses of 40 us beat with the exposures of 200 us; the light comes lag_s behind the pins, and
/// a frame that it misses is dark. Those of dead_s on have none.
Check spotSeenOfSlowPwm(double lag_s, double dead_s) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  const double pwm_s = (frames[1].mid_s - frames[0].mid_s) / 4.06;
  run.evidence.light.clear();
  for (const GateInterval& gate : run.evidence.gates) {
    for (double on_s = std::ceil(gate.on_s / pwm_s) * pwm_s; on_s + 40e-6 < gate.off_s; on_s += pwm_s)
      run.evidence.light.push_back({on_s, on_s + 40e-6});
  }
  std::size_t dark = 0;
  for (vision::FrameMeasurement& frame : frames) {
    frame.exposure_s = 200e-6;
    const double shift_s = frame.mid_s - 0.5 * frame.exposure_s - lag_s;
    const double phase_s = shift_s - std::floor(shift_s / pwm_s) * pwm_s;  // The exposure begins there.
    // 12 us of a pulse are too little to be seen.
    const bool missed = phase_s > 28e-6 && phase_s + frame.exposure_s < pwm_s + 12e-6;
    if (!frame.spot_W_mm || !(missed || frame.mid_s > dead_s)) continue;
    frame.spot_W_mm.reset();
    ++dark;
  }
  EXPECT_GT(dark, 20U);
  return checkOf(run.inspected(), "spot_seen");
}

TEST(Refusals, TheLasersLagDecidesWhichFramesLieBetweenPulses) {
  constexpr double kNever_s = 1e9;
  for (const double lag_s : {0.0, 20e-6, 100e-6}) {
    const Check check = spotSeenOfSlowPwm(lag_s, kNever_s);
    EXPECT_EQ(check.verdict, Verdict::kPass) << lag_s << check.explanation;
  }
  EXPECT_EQ(spotSeenOfSlowPwm(20e-6, 1.0).verdict, Verdict::kInvalid)
      << "no lag explains a laser that is dead";
}

TEST(Refusals, NoLagExcusesALaserThatFailsInFramesInStepWithItsPulses) {
  // Each exposure of 50 us lies within a pulse of 100 us. Another lag would put all of them between two.
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  run.evidence.light.clear();
  for (vision::FrameMeasurement& frame : frames) {
    frame.exposure_s = 50e-6;
    const bool is_open = std::ranges::any_of(run.evidence.gates, [&](const GateInterval& gate) {
      return gate.on_s <= frame.mid_s && frame.mid_s <= gate.off_s;
    });
    if (is_open) run.evidence.light.push_back({frame.mid_s - 50e-6, frame.mid_s + 50e-6});
  }
  ASSERT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kPass);
  const std::size_t dead = run.frameAt(run.evidence.gates.front().on_s + 0.1);
  for (std::size_t i = dead; i < dead + 10; ++i) frames[i].spot_W_mm.reset();
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid)
      << checkOf(run.inspected(), "spot_seen").explanation;
}

TEST(Refusals, ASingleDarkFrameInAThousandIsNoneTwoInARowAre) {
  SyntheticRun run;
  auto& frames = run.evidence.spot.frames;
  const std::size_t dark = run.frameAt(run.evidence.gates.front().on_s + 0.1);
  // The same run again and again, until one frame is less than a thousandth.
  const std::vector<vision::FrameMeasurement> once = frames;
  const std::vector<GateInterval> gates = run.evidence.gates;
  const double period_s = once[1].mid_s - once[0].mid_s;
  const double turn_s = once.back().mid_s + period_s - once.front().mid_s;
  for (int turn = 1; turn < 4; ++turn) {
    for (vision::FrameMeasurement frame : once) {
      frame.mid_s += turn * turn_s;
      frame.sequence = frames.size();
      frames.push_back(frame);
    }
    for (GateInterval gate : gates) {
      gate.on_s += turn * turn_s;
      gate.off_s += turn * turn_s;
      run.evidence.gates.push_back(gate);
    }
  }
  frames[dark].spot_W_mm.reset();
  frames[dark + 2].spot_W_mm.reset();
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kPass);
  EXPECT_NE(checkOf(run.inspected(), "spot_seen").explanation.find("In 2 of "), std::string::npos);
  frames[dark + 1].spot_W_mm.reset();
  EXPECT_EQ(checkOf(run.inspected(), "spot_seen").verdict, Verdict::kInvalid);
}

/// A camera that takes one frame in 31 ms, the last of the first crease dark and so long before the beam gets
/// to its end; the gate stays open for longer than the beam needs at full speed.
Verdict endingDark(double before_end_s, double longer_s) {
  SyntheticRun run;
  const auto crease =
      std::ranges::find_if(run.evidence.gates, [](const GateInterval& gate) {  // 36 mm at 300 mm/s
        return std::abs(gate.off_s - gate.on_s - 0.12) < 2e-3;
      });
  auto& all = run.evidence.spot.frames;
  const std::size_t last = run.frameAt(crease->off_s - before_end_s);
  std::vector<vision::FrameMeasurement> frames;
  for (std::size_t i = last % 31; i < all.size(); i += 31) {
    frames.push_back(all[i]);
    frames.back().sequence = frames.size() - 1;
    if (i == last) frames.back().spot_W_mm.reset();
  }
  all = std::move(frames);
  crease->off_s += longer_s;
  return checkOf(run.inspected(), "spot_seen").verdict;
}

TEST(Refusals, ADarkFrameAtTheEndOfACutIsExcusedWhereTheBeamIsSlow) {
  // From the frame before it the gate takes 55 ms over 9.4 mm: 0.57 of full speed.
  EXPECT_EQ(endingDark(1e-3, 24e-3), Verdict::kPass);
  // 56 ms over 16.8 mm: the beam is as fast as ever.
  EXPECT_EQ(endingDark(25e-3, 0.0), Verdict::kInvalid);
}

/// The same with the last but one of that crease dark, behind one that places the spot so many times worse
/// than usual.
Verdict lastButOneDark(double times_sigma) {
  SyntheticRun run;
  const auto crease =
      std::ranges::find_if(run.evidence.gates, [](const GateInterval& gate) {  // 36 mm at 300 mm/s
        return std::abs(gate.off_s - gate.on_s - 0.12) < 2e-3;
      });
  auto& all = run.evidence.spot.frames;
  const std::size_t last = run.frameAt(crease->off_s - 1e-3);
  std::vector<vision::FrameMeasurement> frames;
  for (std::size_t i = last % 31; i < all.size(); i += 31) {
    frames.push_back(all[i]);
    frames.back().sequence = frames.size() - 1;
    if (i + 31 == last) frames.back().spot_W_mm.reset();
    if (i + 62 == last) frames.back().spot_sigma_mm *= times_sigma;
  }
  all = std::move(frames);
  return checkOf(run.inspected(), "spot_seen").verdict;
}

TEST(Refusals, ADarkFrameIsExcusedBesideAFaintOneThoughOnlyOneIsLeftOfItsCut) {
  EXPECT_EQ(lastButOneDark(3.0), Verdict::kPass);
  EXPECT_EQ(lastButOneDark(1.0), Verdict::kInvalid);
}

/// The same of the first frame of that crease, so long after the beam left its start; the gate opens earlier
/// than the beam needs at full speed.
Verdict beginningDark(double behind_start_s, double earlier_s) {
  SyntheticRun run;
  const auto crease =
      std::ranges::find_if(run.evidence.gates, [](const GateInterval& gate) {  // 36 mm at 300 mm/s
        return std::abs(gate.off_s - gate.on_s - 0.12) < 2e-3;
      });
  auto& all = run.evidence.spot.frames;
  const std::size_t first = run.frameAt(crease->on_s + behind_start_s);
  std::vector<vision::FrameMeasurement> frames;
  for (std::size_t i = first % 31; i < all.size(); i += 31) {
    frames.push_back(all[i]);
    frames.back().sequence = frames.size() - 1;
    if (i == first) frames.back().spot_W_mm.reset();
  }
  all = std::move(frames);
  crease->on_s -= earlier_s;
  return checkOf(run.inspected(), "spot_seen").verdict;
}

TEST(Refusals, ADarkFrameAtTheStartOfACutIsExcusedWhereTheBeamIsSlow) {
  // The gate takes 56 ms over the 9.6 mm to the frame behind it: 0.57 of full speed.
  EXPECT_EQ(beginningDark(1e-3, 24e-3), Verdict::kPass);
  // 56 ms over 16.8 mm: the beam is as fast as ever.
  EXPECT_EQ(beginningDark(25e-3, 0.0), Verdict::kInvalid);
}

TEST(Refusals, TwoFramesOfEachCutTellTheUsualSpeed) {
  // Cuts at 300 mm/s, two frames of each 20 ms apart; then one of which the beam does 1 mm while a frame is
  // dark.
  SyntheticRun run;
  run.evidence.spot.frames.clear();
  run.evidence.gates.clear();
  LitFrames lit;
  lit.period_s = 0.02;
  const auto add = [&](double time_s, double x_mm, bool is_lit) {
    vision::FrameMeasurement& frame = run.evidence.spot.frames.emplace_back();
    frame.sequence = run.evidence.spot.frames.size() - 1;
    frame.mid_s = time_s;
    if (!is_lit) return;
    frame.spot_W_mm = Eigen::Vector2d(x_mm, 0.0);
    frame.spot_sigma_mm = 0.002;
    LitFrame& seen = lit.frames.emplace_back();
    seen.frame = run.evidence.spot.frames.size() - 1;
    seen.time_s = time_s;
    seen.p_S_mm = {x_mm, 0.0};
    seen.entity = kBottom;
    if (lit.frames.size() % 2 == 0) lit.runs.push_back({lit.frames.size() - 2, lit.frames.size()});
  };
  for (int cut = 0; cut < 6; ++cut) {
    const double on_s = 0.1 * cut;
    run.evidence.gates.push_back({on_s, on_s + 0.05});
    for (int i = 0; i < 2; ++i) add(on_s + 0.02 * (i + 0.5), 6.0 * i, true);
  }
  run.evidence.gates.push_back({1.0, 1.1});
  for (const auto& [time_s, x_mm, is_lit] :
       {std::tuple{1.01, 0.0, true}, std::tuple{1.03, 0.5, true}, std::tuple{1.05, 1.0, false},
        std::tuple{1.07, 1.5, true}, std::tuple{1.09, 2.0, true}})
    add(time_s, x_mm, is_lit);
  const Check slow = checks::spotSeenCheck(run.evidence, lit);
  EXPECT_EQ(slow.verdict, Verdict::kPass) << slow.explanation;
}

}  // namespace
}  // namespace kerfbench::inspect

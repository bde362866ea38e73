// SPDX-License-Identifier: Apache-2.0
// What the pins alone prove of the laser, and a beam that rests while it works.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/inspect/checks/spot_checks.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

TEST(InterlockCheck, FailsWhereTheGateStaysOpenBehindAnOpenGuard) {
  SyntheticRun run;
  const GateInterval& gate = run.evidence.gates.at(2);
  const double opened_s = 0.5 * (gate.on_s + gate.off_s);
  run.evidence.guard_open->push_back({opened_s, opened_s + 1.0});
  const auto result = run.inspected();
  const Check& interlock = checkOf(result, "interlock");
  EXPECT_EQ(interlock.verdict, Verdict::kFail);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(InterlockCheck, PassesWhereTheLaserGoesOffInTime) {
  SyntheticRun run;
  const GateInterval& gate = run.evidence.gates.back();
  run.evidence.guard_open->push_back({gate.off_s - 0.9 * kLaserOff_s, gate.off_s + 1e-4});
  EXPECT_EQ(checkOf(run.inspected(), "interlock").verdict, Verdict::kPass);
  run.evidence.guard_open->back().from_s = gate.off_s - 1.1 * kLaserOff_s;
  EXPECT_EQ(checkOf(run.inspected(), "interlock").verdict, Verdict::kFail);
}

TEST(InterlockCheck, JudgesTheWorstOfManyOpenings) {
  SyntheticRun run;
  const GateInterval& early = run.evidence.gates.at(1);
  run.evidence.guard_open->push_back({early.off_s - 0.5 * kLaserOff_s, early.off_s + 1e-4});
  const GateInterval& late = run.evidence.gates.at(2);
  run.evidence.guard_open->push_back({late.off_s - 20.0 * kLaserOff_s, late.off_s});
  const Check interlock = checkOf(run.inspected(), "interlock");
  EXPECT_EQ(interlock.verdict, Verdict::kFail);
  EXPECT_NEAR(interlock.value, 2.0, 1e-6);  // ms
}

TEST(InterlockCheck, SaysWhetherTheLaserWasOffWhileTheGuardWasOpen) {
  SyntheticRun run;
  const double end_s = run.evidence.gates.back().off_s;
  run.evidence.guard_open->push_back({end_s + 0.001, end_s + 0.1});
  EXPECT_THAT(checkOf(run.inspected(), "interlock").explanation,
              HasSubstr("opened 1 times, and the gate was off each time"));
  run.evidence.guard_open->front().from_s = end_s - 0.002;
  EXPECT_THAT(checkOf(run.inspected(), "interlock").explanation,
              HasSubstr("the gate was on until 2 ms later"));
}

TEST(InterlockCheck, WithoutTheWireItDoesNotApply) {
  SyntheticRun run;
  run.evidence.guard_open.reset();
  const auto result = run.inspected();
  EXPECT_FALSE(hasCheck(result, "interlock"));
  EXPECT_FALSE(unjudgedOf(result, "interlock").applies);
  EXPECT_EQ(result.verdict, Verdict::kPass);
}

/// Lets the spot of the first cut rest at its place for some frames, all later ones so much later.
void rest(SyntheticRun& run, std::size_t frames) {
  auto& all = run.evidence.spot.frames;
  const GateInterval gate = run.evidence.gates.front();
  const auto at = std::ranges::find_if(
      all, [&](const vision::FrameMeasurement& f) { return f.spot_W_mm && f.mid_s > gate.on_s + 0.05; });
  ASSERT_NE(at, all.end());
  const double wait_s = 1e-3 * static_cast<double>(frames);
  const double from_s = at->mid_s;
  const vision::FrameMeasurement still = *at;
  for (auto later = at; later != all.end(); ++later) {
    later->mid_s += wait_s;
    later->sequence += frames;
  }
  std::vector<vision::FrameMeasurement> resting(frames, still);
  for (std::size_t i = 0; i < frames; ++i) {
    resting[i].mid_s += 1e-3 * static_cast<double>(i);
    resting[i].sequence += i;
  }
  all.insert(at, resting.begin(), resting.end());
  const auto delay = [&](double& time_s) { time_s += time_s > from_s ? wait_s : 0.0; };
  for (GateInterval& g : run.evidence.gates) {
    delay(g.on_s);
    delay(g.off_s);
  }
  for (Span& s : run.evidence.light) {
    delay(s.from_s);
    delay(s.to_s);
  }
  run.evidence.belt.clear();
}

TEST(DwellCheck, FailsWhereTheBeamRestsWithTheLaserOn) {
  SyntheticRun run;
  rest(run, 50);
  const auto result = run.inspected();
  const Check& dwell = checkOf(result, "dwell");
  EXPECT_EQ(dwell.verdict, Verdict::kFail);
  EXPECT_NEAR(dwell.value, 50e-3 * 300.0, 1.0) << "50 ms at 300 mm/s";
}

TEST(DwellCheck, SaysInWordsThatTheBeamRestsOnNoDrawnLine) {
  SyntheticRun run;
  rest(run, 50);
  EXPECT_EQ(checkOf(run.inspected(), "dwell").subject, "unit 0, E0");
  for (vision::FrameMeasurement& frame : run.evidence.spot.frames)
    if (frame.spot_W_mm) *frame.spot_W_mm += Eigen::Vector2d(0.5, 0.5);
  const auto result = run.inspected();
  EXPECT_THAT(checkOf(result, "dwell").subject,
              MatchesRegex("unit 0, along no drawn line at x 15\\.[0-9]+, y 0\\.5[0-9] mm"));
  EXPECT_THAT(checkOf(result, "spot_path").subject, HasSubstr("along no drawn line at x"));
  for (const Check& check : result.checks)
    EXPECT_THAT(check.subject + check.explanation, Not(HasSubstr("E-"))) << check.name;
}

TEST(DwellCheck, ARestInTheDarkDoesNoHarm) {
  SyntheticRun run;
  const double on_s = run.evidence.gates.front().on_s;
  rest(run, 50);
  // The PWM is at nought while the beam rests.
  Span& first = run.evidence.light.front();
  const double off_s = first.to_s;
  first.to_s = on_s + 0.05;
  run.evidence.light.insert(run.evidence.light.begin() + 1, Span{on_s + 0.101, off_s});
  EXPECT_EQ(checkOf(run.inspected(), "dwell").verdict, Verdict::kPass);
}

/// Lets the laser work at less than full power along the cuts, and at full power for so long at the end of
/// the first, which one frame sees.
void burnAtEnd(SyntheticRun& run, double cut_share, double full_power_s) {
  std::vector<Span> light;
  for (const GateInterval& gate : run.evidence.gates) {
    for (double from_s = gate.on_s; from_s < gate.off_s; from_s += 1e-4)
      light.push_back({from_s, from_s + 1e-4 * cut_share});
  }
  const auto ends_in_jump = std::ranges::adjacent_find(
      run.evidence.gates,
      [](const GateInterval& gate, const GateInterval& next) { return next.on_s - gate.off_s > 5e-3; });
  ASSERT_NE(ends_in_jump, run.evidence.gates.end());
  GateInterval& cut = *ends_in_jump;
  auto& frames = run.evidence.spot.frames;
  const auto after =
      std::ranges::find_if(frames, [&](const vision::FrameMeasurement& f) { return f.mid_s > cut.off_s; });
  const vision::FrameMeasurement& last = *(after - 1);
  const double belt_mm_s = (run.evidence.belt.back().x_mm - run.evidence.belt.front().x_mm) /
                           (run.evidence.belt.back().time_s - run.evidence.belt.front().time_s);
  after->spot_W_mm = *last.spot_W_mm + Eigen::Vector2d(belt_mm_s * (after->mid_s - last.mid_s), 0.0);
  after->spot_sigma_mm = last.spot_sigma_mm;
  light.push_back({cut.off_s, cut.off_s + full_power_s});
  cut.off_s += full_power_s;
  std::ranges::sort(light, {}, &Span::from_s);
  run.evidence.light = std::move(light);
}

TEST(DwellCheck, LightWithinTheFramesBesideARestIsOpen) {
  // A third of full power along cuts at 300 mm/s: full power gives as much light in 1 ms as a millimetre
  // gets.
  SyntheticRun run;
  burnAtEnd(run, 0.3, 1.2e-3);
  const auto result = run.inspected();
  const Check& dwell = checkOf(result, "dwell");
  EXPECT_EQ(dwell.verdict, Verdict::kNotProven) << dwell.explanation;
  SyntheticRun less;
  burnAtEnd(less, 0.3, 0.3e-3);
  EXPECT_EQ(checkOf(less.inspected(), "dwell").verdict, Verdict::kPass);
}

/// Ten frames of a cut at half power, a step apart, then ten at rest in the dark, and one alone; the beam is
/// on for one more frame behind the last of the cut, at this share of full power.
Finding cutThenDark(double last_share, double step_mm = 0.3) {
  constexpr double kPeriod_s = 1e-3;
  dieline::Dieline dieline;
  dieline.entities.push_back(
      {0, dieline::LineCurve{{0, 0}, {40, 0}}, dieline::Process::kCut, "CUT", "line 4: LINE"});
  Evidence evidence;
  evidence.dieline = &dieline;
  LitFrames lit;
  lit.period_s = kPeriod_s;
  for (int i = 0; i < 21; ++i) {
    LitFrame& frame = lit.frames.emplace_back();
    frame.time_s = (i < 10 ? i : i < 20 ? i + 100 : i + 200) * kPeriod_s;
    frame.p_S_mm = {i < 10 ? step_mm * i : 20.0, 0.0};
    frame.entity = 0;
  }
  lit.runs = {{0, 10}, {10, 20}, {20, 21}};
  for (int i = -10; i < 100; ++i) {  // A tenth of a frame each.
    const double from_s = 0.1 * i * kPeriod_s;
    evidence.light.push_back({from_s, from_s + (i < 90 ? 0.5 : last_share) * 0.1 * kPeriod_s});
  }
  return checks::dwellCheck(evidence, Tolerances{}, lit);
}

TEST(DwellCheck, BehindARunItsOwnLastStepTellsWhatItsWayGets) {
  const Finding check = cutThenDark(0.5);
  EXPECT_NEAR(check->value, 0.0, 1e-6) << "what the beam burns on its way on from the last frame";
}

TEST(DwellCheck, OfLightBesideARestNoneToAllMayHaveFallenThere) {
  const Finding all = cutThenDark(0.5);
  const Finding check = cutThenDark(1.0);
  // Half of full power for a frame is what 0.3 mm of the cut get.
  EXPECT_NEAR(check->value, 0.15, 1e-6);
  EXPECT_NEAR(check->guard - all->guard, 0.15, 1e-6);
}

TEST(DwellCheck, WhatLiesBetweenFramesThatAreFarApartIsNotGuessed) {
  const Finding fine = cutThenDark(0.5);
  const Finding check = cutThenDark(1.0, 4.0 * Tolerances{}.dwell_mm);
  EXPECT_EQ(check->value, 0.0);
  EXPECT_NEAR(check->guard, fine->guard - fine->value, 1e-9);
}

TEST(DwellCheck, AFlawlessRunRestsNowhere) {
  const SyntheticRun run;
  const auto result = run.inspected();
  const Check& dwell = checkOf(result, "dwell");
  EXPECT_LT(dwell.value, 0.7);
  EXPECT_LT(dwell.guard, 0.25) << "no light beside what the spot's own way gets";
  EXPECT_EQ(dwell.verdict, Verdict::kPass);
}

TEST(Unjudged, EachCheckIsJudgedOrListedWithItsReason) {
  SyntheticRun run;
  const auto result = run.inspected();
  for (const char* name :
       {"path",          "joints",      "coverage",       "bridges",    "depth",         "even_depth",
        "ordered_depth", "line_energy", "perforation",    "kerf_width", "ordered_width", "stray",
        "laser_timing",  "stillness_x", "stillness_peak", "belt",       "spot_seen",     "spot_path",
        "repeat",        "dwell",       "gate_lag",       "laser_gate", "interlock",     "pulse_timing",
        "account",       "finish"}) {
    const bool judged = hasCheck(result, name);
    const auto listed = std::ranges::count(result.unjudged, name, &Unjudged::name);
    EXPECT_EQ(listed, judged ? 0 : 1) << name;
    if (judged) continue;
    EXPECT_FALSE(unjudgedOf(result, name).reason.empty()) << name;
  }
}

TEST(Unjudged, AnAbsentReportOfTheControllerIsToldApartFromOneThatNobodyExpects) {
  SyntheticRun run;
  EXPECT_FALSE(unjudgedOf(run.inspected(), "account").applies);
  run.evidence.words_expected = true;
  run.evidence.no_words = "The recording holds nothing that the controller said.";
  const auto result = run.inspected();
  EXPECT_TRUE(unjudgedOf(result, "account").applies);
  EXPECT_TRUE(unjudgedOf(result, "finish").applies);
  EXPECT_EQ(unjudgedOf(result, "finish").reason, run.evidence.no_words);
}

TEST(Doubts, DoNotOutweighALineThatIsNotThere) {
  SyntheticRun run;
  run.evidence.spot_calibration->area_mm =
      Eigen::AlignedBox2d(Eigen::Vector2d(1e4, 1e4), Eigen::Vector2d(2e4, 2e4));
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  for (vision::Caliper& c : run.kerf(1, kHole).calipers) {
    c.found = false;
    c.brightness = 0.0;
    c.offset_mm = c.width_mm = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_EQ(run.inspected().verdict, Verdict::kFail) << "a hole that is missing is missing";
  EXPECT_FALSE(run.inspected().problems.empty());
  run.evidence.problems.emplace_back("Gap in the pin stream at 1.2 s.");
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid) << "what was recorded is spoiled";
}

TEST(Doubts, DoNotOutweighALaserBehindAnOpenGuard) {
  SyntheticRun run;
  run.evidence.guard_problems.emplace_back("interlock: 1 of 2 edges that were driven are not the machine's");
  auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kInvalid) << "nobody knows who opened the guard";
  EXPECT_THAT(result.problems, ::testing::ElementsAre(HasSubstr("not the machine's")));
  run.evidence.guard_open->push_back({run.evidence.gates.back().off_s - 0.01, 100.0});
  result = run.inspected();
  EXPECT_EQ(checkOf(result, "interlock").verdict, Verdict::kFail);
  EXPECT_EQ(result.verdict, Verdict::kFail) << "whoever opened it, the laser stayed on";
  EXPECT_THAT(result.problems, ::testing::ElementsAre(HasSubstr("not the machine's")));
  run.evidence.problems.emplace_back("Gap in the pin stream at 1.2 s.");
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid) << "what was recorded is spoiled";
}

TEST(Unjudged, ACutThatLiesElsewhereIsOneFaultAndNotMany) {
  SyntheticRun run;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) {
      // Here and there another line's kerf crosses the caliper.
      if (static_cast<int>(c.station_mm) % 4 == 0) {
        c.offset_mm = 0.5;
        c.width_mm = 0.4;
        continue;
      }
      c.found = false;
      c.brightness = 0.0;
      c.offset_mm = c.width_mm = std::numeric_limits<double>::quiet_NaN();
    }
  }
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "coverage").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "path").verdict, Verdict::kFail);
  for (const char* name : {"kerf_width", "depth"}) {
    EXPECT_FALSE(hasCheck(result, name)) << name;
    EXPECT_TRUE(unjudgedOf(result, name).applies) << name;
  }
}

TEST(Unjudged, NothingCutLeavesOneCauseAndNoGuesses) {
  SyntheticRun run;
  for (vision::EntityKerf& kerf : run.evidence.kerf.entities) {
    for (vision::Caliper& c : kerf.calipers) {
      c.found = false;
      c.brightness = 0.0;
      c.offset_mm = c.width_mm = std::numeric_limits<double>::quiet_NaN();
    }
  }
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "coverage").verdict, Verdict::kFail);
  EXPECT_FALSE(hasCheck(result, "path"));
  EXPECT_TRUE(unjudgedOf(result, "path").applies);
}

}  // namespace
}  // namespace kerfbench::inspect

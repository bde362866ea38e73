// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "player.h"

namespace kerfbench::planner {
namespace {

using test::play;
using test::Played;
using ::testing::HasSubstr;

/// Hu, Hu, Jiang 2014: pieces of 1200 mm off a strip 800 mm wide.
JobParameters stripJob() {
  JobParameters job = test::gantryJob();
  job.units = 4;
  job.pitch_mm = 1200.0;
  job.alternate = true;
  job.belt_speed_mm_s = 200.0;
  return job;
}

std::string refusal(const dieline::Dieline& dieline, const MachineParameters& machine,
                    const JobParameters& job) {
  try {
    planner::plan(dieline, machine, job);
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

TEST(Strip, ThePapersExampleRuns) {
  const Plan plan = planner::plan(test::strip(), test::gantry(), stripJob());
  // The cut takes 800/230 s and the ramps, the cycle has to fit into 6 s.
  EXPECT_GT(plan.unit_time_s, 800.0 / 230.0);
  EXPECT_LT(plan.unit_time_s, 3.75);
  EXPECT_LT(plan.cycle_time_s, 6.0);
  const Played played = play(plan.program, test::gantry(), stripJob());
  EXPECT_EQ(played.error, "");
  EXPECT_EQ(played.marks_waited, 4);
  EXPECT_LT(test::worstDeviationMm(played, test::strip(), stripJob()), 0.015);
  for (int unit = 0; unit < 4; ++unit)
    EXPECT_LT(test::worstGapMm(played, test::strip(), stripJob(), unit), 0.015);
}

TEST(Strip, AReturnTooSlowForThePitchIsRefused) {
  JobParameters job = stripJob();
  job.jump_speed_mm_s = 250.0;  // The paper's bound is 275.9 mm/s for 1200 mm.
  const std::string why = refusal(test::strip(), test::gantry(), job);
  EXPECT_THAT(why, HasSubstr("pitch of 1200 mm"));
  EXPECT_THAT(why, HasSubstr("200 mm/s is too high"));
}

TEST(Strip, AReleaseThatDoesNotCheckTheReturnComesLate) {
  JobParameters job = stripJob();
  job.jump_speed_mm_s = 250.0;
  const PlannerFaults unchecked{.return_unchecked = true};
  const Plan late = planner::plan(test::strip(), test::gantry(), job, unchecked);
  EXPECT_GT(late.cycle_time_s, job.pitch_mm / job.belt_speed_mm_s);
  EXPECT_EQ(play(late.program, test::gantry(), job).marks_waited, 4);
}

TEST(Strip, TheReturnUncheckedIsNoFaultWhereItIsFastEnough) {
  const Plan checked = planner::plan(test::strip(), test::gantry(), stripJob());
  const Plan unchecked =
      planner::plan(test::strip(), test::gantry(), stripJob(), PlannerFaults{.return_unchecked = true});
  EXPECT_LT(checked.max_belt_speed_mm_s, unchecked.max_belt_speed_mm_s);
  EXPECT_EQ(checked.program.ops, unchecked.program.ops);
}

TEST(Strip, AFieldTooShortForTheCutIsRefused) {
  MachineParameters machine = test::gantry();
  machine.field_max_mm[0] = 660.0;  // The travel is 680 mm; the paper needs 695.7 mm.
  EXPECT_THAT(refusal(test::strip(), machine, stripJob()), HasSubstr("leaves the field"));
}

TEST(Strip, EverySecondCutRunsBack) {
  const Played played =
      play(planner::plan(test::strip(), test::gantry(), stripJob()).program, test::gantry(), stripJob());
  std::vector<double> senses;
  bool open = false;
  for (const test::Period& period : played.periods) {
    if (period.power >= 0 && !open) senses.push_back(0.0);
    open = period.power >= 0;
    if (open) senses.back() += period.to_W_mm.y() - period.from_W_mm.y();
  }
  ASSERT_EQ(senses.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(senses[i], i % 2 == 0 ? senses[0] : -senses[0], 0.02);
  EXPECT_NEAR(std::abs(senses[0]), 800.0, 0.03);
}

TEST(BeltSpeed, HighestIsFoundToATenthOfAPercent) {
  JobParameters job = test::mirrorJob();
  const double highest = planner::plan(test::label(), test::twoMirror(), job).max_belt_speed_mm_s;
  EXPECT_GT(highest, 200.0);
  job.belt_speed_mm_s = highest * 0.999;
  EXPECT_EQ(refusal(test::label(), test::twoMirror(), job), "");
  job.belt_speed_mm_s = highest * 1.002;
  const std::string why = refusal(test::label(), test::twoMirror(), job);
  EXPECT_THAT(why, HasSubstr("E6 leaves the field"));
  EXPECT_THAT(why, HasSubstr("the highest for this job is 21"));
}

TEST(BeltSpeed, BeyondTheAxisItIsTheAxis) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 600.0;
  const auto dot = test::dielineOf({test::line(0, 0, -0.5, 0)});
  EXPECT_THAT(refusal(dot, test::twoMirror(), job), HasSubstr("x axis makes no more than"));
}

TEST(BeltSpeed, BrokenOutlinesAllowMore) {
  JobParameters job = test::mirrorJob();
  job.order = JobParameters::Order::kNearest;  // The shortest path is for the configured speed.
  job.belt_speed_mm_s = 5.0;
  const double whole = planner::plan(test::carton(), test::twoMirror(), job).max_belt_speed_mm_s;
  job.belt_speed_mm_s = 50.0;
  EXPECT_GT(planner::plan(test::carton(), test::twoMirror(), job).max_belt_speed_mm_s, 4.0 * whole);
}

TEST(Units, SeveralLabelsOnTheWeb) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 100.0;
  job.units = 3;
  job.pitch_mm = 150.0;
  job.eye_mark_x_mm = 4.0;
  const Played played =
      play(planner::plan(test::label(), test::twoMirror(), job).program, test::twoMirror(), job);
  EXPECT_EQ(played.error, "");
  EXPECT_LT(test::worstDeviationMm(played, test::label(), job), 0.015);
  for (int unit = 0; unit < 3; ++unit) EXPECT_LT(test::worstGapMm(played, test::label(), job, unit), 0.015);
  job.pitch_mm = 80.0;
  EXPECT_THAT(refusal(test::label(), test::twoMirror(), job), HasSubstr("pitch of 80 mm"));
}

TEST(Units, MoreMarksThanTheControllerHoldsAreRefused) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 20.0;
  job.units = 20;
  job.pitch_mm = 12.0;  // The distance from the sensor to the field is some 140 mm: a dozen marks wait.
  const auto dot = test::dielineOf({test::line(0, 0, -1, 0)});
  EXPECT_THAT(refusal(dot, test::twoMirror(), job), HasSubstr("the controller holds 7"));
  job.pitch_mm = 40.0;
  EXPECT_EQ(refusal(dot, test::twoMirror(), job), "");
}

TEST(Units, OnARestingSheetWithoutMarks) {
  JobParameters job = test::mirrorJob();
  job.units = 2;
  job.pitch_mm = 40.0;
  job.web_start_x_mm = 40.0;
  const auto dieline = test::dielineOf({test::arc(-15, 0, 10, 0, 360)});
  const Played played = play(planner::plan(dieline, test::twoMirror(), job).program, test::twoMirror(), job);
  EXPECT_EQ(played.error, "");
  EXPECT_EQ(played.marks_waited, 0);
  for (const test::Period& period : played.periods) EXPECT_FALSE(period.following);
}

TEST(Follow, IsOnForTheWholeUnitWithTheRightGain) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 150.0;
  const MachineParameters machine = test::twoMirror();
  const Played played = play(planner::plan(test::label(), machine, job).program, machine, job);
  for (const test::Period& period : played.periods) {
    if (period.power >= 0) {
      EXPECT_TRUE(period.following);
    }
    if (!period.following) continue;
    // One belt count more must move the spot by one count: a finite difference of S4's eq. 1.
    const double arm = std::hypot(machine.throw_mm, period.to_W_mm.y()) + machine.mirror_spacing_mm;
    const double angle = std::atan(period.to_W_mm.x() / arm);
    const double moved =
        arm * (std::tan(angle + 2.0 * period.gain * machine.mirror_step_rad) - std::tan(angle));
    EXPECT_NEAR(moved, machine.encoder_count_mm, 0.003 * machine.encoder_count_mm);
  }
  EXPECT_FALSE(played.periods.front().following);
  EXPECT_FALSE(played.periods.back().following);
}

TEST(Feed, ByTheControllerNeedsNoMarks) {
  MachineParameters machine = test::gantry();
  machine.feed_step_mm = 0.02;  // 200 mm/s are 8 steps in each period exactly
  JobParameters job = stripJob();
  job.feed_by_controller = true;
  job.web_start_x_mm = -300.0;
  const Played played = play(planner::plan(test::strip(), machine, job).program, machine, job);
  EXPECT_EQ(played.error, "");
  EXPECT_EQ(played.marks_waited, 0);
  EXPECT_GT(played.feed_steps * machine.feed_step_mm, 3 * 1200.0);
  // A feed step is 20 um, half of which the rounding may cost.
  EXPECT_LT(test::worstDeviationMm(played, test::strip(), job), 0.030);
  for (int unit = 0; unit < 4; ++unit) EXPECT_LT(test::worstGapMm(played, test::strip(), job, unit), 0.030);
}

TEST(Feed, StopAndGoTakesThePapersTime) {
  MachineParameters machine = test::gantry();
  machine.feed_step_mm = 0.02;
  JobParameters job = stripJob();
  job.feed_by_controller = true;
  job.stop_and_go = true;
  job.web_start_x_mm = 300.0;
  const Plan plan = planner::plan(test::strip(), machine, job);
  // The paper's 9.5 s a piece know no ramps: 0.4 s of the feed at 500 mm/s², 0.092 s of the cut.
  EXPECT_NEAR(plan.cycle_time_s, 6.0 + 800.0 / 230.0 + 0.4 + 0.092, 0.005);
  EXPECT_GT(plan.cycle_time_s, planner::plan(test::strip(), test::gantry(), stripJob()).cycle_time_s * 1.5);
  const Played played = play(plan.program, machine, job);
  EXPECT_EQ(played.error, "");
  EXPECT_EQ(played.feed_steps, 3 * 60000);
  EXPECT_LT(test::worstDeviationMm(played, test::strip(), job), 0.015);
  for (int unit = 0; unit < 4; ++unit) EXPECT_LT(test::worstGapMm(played, test::strip(), job, unit), 0.015);
  job.belt_speed_mm_s = 800.0;
  EXPECT_THAT(refusal(test::strip(), machine, job), HasSubstr("no more than 700.0 mm/s"));
}

TEST(Faults, EachMakesTheCutWrong) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 100.0;
  const MachineParameters machine = test::twoMirror();
  const auto deviation = [&](const PlannerFaults& faults) {
    return test::worstDeviationMm(
        play(planner::plan(test::label(), machine, job, faults).program, machine, job), test::label(), job);
  };
  EXPECT_LT(deviation({}), 0.015);
  EXPECT_GT(deviation({.ignore_belt = true}), 5.0);
  EXPECT_GT(deviation({.no_pincushion = true}), 0.5);
  const PlannerFaults skip{.skip_entity = 3};
  EXPECT_GT(test::worstGapMm(play(planner::plan(test::label(), machine, job, skip).program, machine, job),
                             test::label(), job, 0),
            0.5);
}

}  // namespace
}  // namespace kerfbench::planner

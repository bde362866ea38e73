// SPDX-License-Identifier: Apache-2.0
// Marks that begin and end at speed: S0's strip, whose v_y is even in the cut, and outlines with jumps.
#include "firmware_under_test/planner/motion/run_up.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/program/check.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

JobParameters stripJob() {
  JobParameters job = test::gantryJob();
  job.acceleration_mm_s2 = 3000.0;
  job.belt_speed_mm_s = 200.0;
  job.units = 2;
  job.pitch_mm = 1200.0;
  job.alternate = true;
  return job;
}

/// Slowest and fastest burning period, mm/s over the sheet.
struct Evenness {
  double slowest_mm_s{1e9}, fastest_mm_s{0.0};
};

Evenness evennessOf(const test::Played& played, double period_s) {
  Evenness even;
  for (const test::Period& period : played.periods) {
    if (period.power <= 0) continue;
    const double speed_mm_s = (period.to_S_mm - period.from_S_mm).norm() / period_s;
    even.slowest_mm_s = std::min(even.slowest_mm_s, speed_mm_s);
    even.fastest_mm_s = std::max(even.fastest_mm_s, speed_mm_s);
  }
  return even;
}

TEST(RunUp, OfThePapersStripLeavesTheCutAtOneSpeed) {
  JobParameters job = stripJob();
  const double period_s = test::gantry().target.periodS();
  const double step_mm_s = test::gantry().gantry_step_mm / period_s;  // A period holds whole steps.
  const auto played = [&] {
    return test::play(plan(test::strip(), test::gantry(), job).program, test::gantry(), job);
  };
  EXPECT_LT(evennessOf(played(), period_s).slowest_mm_s, 20.0) << "without, a cut begins at rest";
  job.run_up_mm = kRunUpOfSpeed;
  const test::Played with = played();
  EXPECT_EQ(with.error, "");
  EXPECT_GT(evennessOf(with, period_s).slowest_mm_s, 0.99 * 230.0 - step_mm_s);
  EXPECT_LT(evennessOf(with, period_s).fastest_mm_s, 230.0 + 1.5 * step_mm_s);
  EXPECT_LT(test::worstDeviationMm(with, test::strip(), job), 0.02);
  EXPECT_LT(test::worstGapMm(with, test::strip(), job, 0), 0.2);
  EXPECT_LT(test::worstGapMm(with, test::strip(), job, 1), 0.2);
}

TEST(RunUp, TakesTheRampAndAPeriod) {
  FlowLimits limits;
  limits.mark_mm_s = 230.0;
  limits.acceleration_mm_s2 = limits.jump_acceleration_mm_s2 = 3000.0;
  limits.period_s = 8e-4;
  EXPECT_NEAR(runUpMm(limits), 230.0 * 230.0 / (2.0 * 3000.0) + 230.0 * 8e-4, 1e-9);
  limits.jerk_mm_s3 = 1e5;  // v (v / a + a / j) / 2
  EXPECT_NEAR(runUpMm(limits), 230.0 * (230.0 / 3000.0 + 3000.0 / 1e5) / 2.0 + 230.0 * 8e-4, 1e-9);
}

TEST(RunUp, StandsAtEachJumpAndNotAtCorners) {
  JobParameters job = test::mirrorJob();
  job.web_start_x_mm = 70.0;
  job.run_up_mm = kRunUpOfSpeed;
  for (const dieline::Dieline& shape : {test::label(), test::carton()}) {
    const Plan planned = plan(shape, test::twoMirror(), job);
    const test::Played played = test::play(planned.program, test::twoMirror(), job);
    EXPECT_EQ(played.error, "");
    EXPECT_LT(test::worstDeviationMm(played, shape, job), 0.03);
    EXPECT_LT(test::worstGapMm(played, shape, job, 0), 0.4);
  }
}

TEST(RunUp, ThatLeavesTheFieldIsRefused) {
  JobParameters job = stripJob();
  job.run_up_mm = 11.0;  // The field goes on for 10 mm beside the strip.
  const CheckResult checked = checkJob("G00 X0 Y-400\nG01 X0 Y400 Z1\n", test::gantry(), job);
  EXPECT_THAT(
      checked.errors,
      Contains(HasSubstr("run-ups take the beam to y -411.000 … 411.000 mm, the field -410 … 410 mm")));
}

TEST(RunUp, IsForStraightJumps) {
  JobParameters job = stripJob();
  job.run_up_mm = kRunUpOfSpeed;
  job.jump_radius_mm = 5.0;
  EXPECT_THAT(checkJob("G00 X0 Y-400\nG01 X0 Y400 Z1\n", test::gantry(), job).errors,
              Contains(HasSubstr("run_up_mm is for straight jumps")));
}

}  // namespace
}  // namespace kerfbench::planner

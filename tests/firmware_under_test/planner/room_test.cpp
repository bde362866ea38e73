// SPDX-License-Identifier: Apache-2.0
// S0's two constraints, for the speed that a job is planned for and for the speeds that the belt may have.
#include "firmware_under_test/planner/program/room.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The paper's strip, four pieces cut forth and back.
class StripRoom : public testing::Test {
 protected:
  StripRoom() {
    job_.belt_speed_mm_s = 200.0;
    job_.units = 4;
    job_.pitch_mm = 1200.0;
    job_.alternate = true;
    text_ = makeGcode(test::strip(), machine_, job_);
  }
  [[nodiscard]] CheckResult checked() const { return checkJob(text_, machine_, job_); }
  [[nodiscard]] RoomNeeded roomAtSpeed(double v) const {
    return roomAt(*checked().solution, machine_, job_, Axes(machine_, {}), v);
  }

  MachineParameters machine_ = test::gantry();
  JobParameters job_ = test::gantryJob();
  std::string text_;
};

TEST_F(StripRoom, ExceedsItsClosedFormByTheRamps) {
  const auto closed = closedFormRoom(unitOf(readGcode(text_)), machine_, job_, 200.0);
  ASSERT_TRUE(closed);
  // Hu, Hu, Jiang 2014 (S0): v_x y_0 / v_y <= x_0, so x_0 >= 695.7 mm.
  EXPECT_NEAR(closed->travel_mm, 695.65, 0.01);
  EXPECT_NEAR(closed->least_pitch_mm, 200.0 / 230.0 * (200.0 / 400.0 + 1.0) * 800.0, 1e-6);
  const RoomNeeded room = roomAtSpeed(200.0);
  EXPECT_GT(room.high_x_mm - room.low_x_mm, closed->travel_mm);
  EXPECT_LT(room.high_x_mm - room.low_x_mm, 1.06 * closed->travel_mm);
  EXPECT_GT(room.least_pitch_mm, closed->least_pitch_mm);
  // The least pitch is where the planner begins to refuse; it finds the highest speed to 0.1 %.
  job_.pitch_mm = 1.002 * room.least_pitch_mm;
  EXPECT_THAT(checked().errors, IsEmpty());
  job_.pitch_mm = room.least_pitch_mm - 0.5;
  EXPECT_THAT(checked().errors, Contains(HasSubstr("pitch of")));
}

TEST_F(StripRoom, AFasterBeltTakesMoreOfItAndASlowerOneLess) {
  const RoomNeeded slow = roomAtSpeed(190.0), planned = roomAtSpeed(200.0), fast = roomAtSpeed(210.0);
  EXPECT_LT(slow.high_x_mm, planned.high_x_mm);
  EXPECT_GT(fast.high_x_mm, planned.high_x_mm);
  EXPECT_LT(slow.least_pitch_mm, planned.least_pitch_mm);
  EXPECT_GT(fast.least_pitch_mm, planned.least_pitch_mm);
  // The cut takes y0 / v_y and a ramp at each end, whatever the belt does: so much more of the belt passes.
  const double cut_s = 800.0 / 230.0;
  EXPECT_GT(fast.high_x_mm - planned.high_x_mm, 10.0 * cut_s);
  EXPECT_LT(fast.high_x_mm - planned.high_x_mm, 10.0 * (cut_s + 0.5));
}

/// Periods of a program, decoded, that a belt of another speed takes along.
double farthestCarried_mm(const Plan& plan, const MachineParameters& machine, JobParameters job, double v) {
  const double planned_mm_s = job.belt_speed_mm_s;
  double farthest_mm = 0.0, more_mm = 0.0;
  for (const test::Period& period : test::play(plan.program, machine, job).periods) {
    if (period.unit > 0) break;
    more_mm = period.following ? more_mm + (v - planned_mm_s) * plan.program.target.periodS() : 0.0;
    if (period.power >= 0) farthest_mm = std::max(farthest_mm, period.to_W_mm.x() + more_mm);
  }
  return farthest_mm;
}

TEST_F(StripRoom, IsThatOfTheDecodedProgramOnAFasterBelt) {
  const Plan plan = planFromGcode(text_, machine_, job_);
  EXPECT_NEAR(farthestCarried_mm(plan, machine_, job_, 200.0), roomAtSpeed(200.0).high_x_mm, 0.5);
  EXPECT_NEAR(farthestCarried_mm(plan, machine_, job_, 204.0), roomAtSpeed(204.0).high_x_mm, 0.5);
}

TEST_F(StripRoom, IsCheckedForTheLowestAndTheHighestSpeedOfTheBelt) {
  job_.belt_min_mm_s = 196.0;
  job_.belt_max_mm_s = 204.0;
  EXPECT_THAT(checked().errors, IsEmpty());
  job_.belt_max_mm_s = 250.0;
  EXPECT_THAT(checked().errors,
              Contains(HasSubstr("at 250 mm/s, the highest speed of the belt, E0 is carried to x_W = ")));
  EXPECT_THAT(checked().errors, Contains(HasSubstr("mm of belt pass in a cycle, the pitch is 1200 mm")));
  EXPECT_FALSE(checked().solution);
}

TEST_F(StripRoom, MustHoldTheBeltsSpeedBetweenItsBounds) {
  job_.belt_min_mm_s = 201.0;
  EXPECT_THAT(checked().errors,
              Contains(HasSubstr("must lie between the lowest and the highest, but these are 201 and 0")));
  job_.belt_min_mm_s = 0.0;
  job_.belt_max_mm_s = 199.0;
  EXPECT_THAT(checked().errors, Contains(HasSubstr("but these are 0 and 199")));
}

TEST(Room, ASlowBeltLeavesLaterMarksUpstreamOfTheField) {
  // Two marks 155 mm apart on a field of 160 mm: the second is cut when the belt has brought it.
  const MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 60.0;
  const std::string text = "G00 X0 Y-70\nG01 X0 Y70 Z1\nG00 X-155 Y0\nG01 X-155 Y20 Z1\n";
  EXPECT_THAT(checkJob(text, machine, job).errors, IsEmpty());
  job.belt_min_mm_s = 40.0;
  EXPECT_THAT(checkJob(text, machine, job).errors,
              Contains(HasSubstr("at 40 mm/s, the lowest speed of the belt, G-code line 4 lies at x_W = ")));
}

}  // namespace
}  // namespace kerfbench::planner

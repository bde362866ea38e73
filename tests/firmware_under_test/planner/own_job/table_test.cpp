// SPDX-License-Identifier: Apache-2.0
// Tables of control programs, read back by a decoder that knows only their comment.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/controller/protocol.h"
#include "player.h"
#include "small_job.h"

namespace kerfbench::planner {
namespace {

using test::Shown;
using ::testing::HasSubstr;

/// Beam on the web at the end of a period: eq. 1 of Cheng, Cui, Zhang 2014, and eq. 3 with t from the mark.
Eigen::Vector2d onSheet(const Shown& period, const OwnJob& job) {
  const MachineParameters machine = test::smallMachine();
  const JobParameters asked = test::smallJob();
  const double y = machine.throw_mm * std::tan(2.0 * machine.mirror_step_rad * period.steps.y());
  const double x = (std::hypot(machine.throw_mm, y) + machine.mirror_spacing_mm) *
                   std::tan(2.0 * machine.mirror_step_rad * period.steps.x());
  const double t_s = job.table.mark_ticks * job.account.target.tick_s +
                     period.since_mark * job.account.target.periodS() + machine.tracking_delay_s;
  return {x - (machine.print_mark_sensor_x_mm - asked.eye_mark_x_mm + asked.belt_speed_mm_s * t_s), y};
}

TEST(OwnJobTable, EveryLitPeriodEndsWithinAStepOfTheLine) {
  for (const char* mcu : {"at89s52", "stc15f2k60s2"}) {
    const OwnJob job = test::makeSmallJob({.mcu = mcu});
    // A step turns the beam by 25 urad over 515 mm on the axis, and half a step is rounded on each of two.
    const double step_mm = 2.0 * 12.5e-6 * 515.0;
    double worst_mm = 0.0;
    int lit[3] = {0, 0, 0};
    for (const Shown& period : test::periodsIn(job.source, job.table)) {
      if (period.power < 0) continue;
      ASSERT_TRUE(period.unit >= 0 && period.unit < 3);
      ++lit[period.unit];
      worst_mm = std::max(worst_mm, test::distanceFromOutline(onSheet(period, job)));
    }
    EXPECT_LT(worst_mm, step_mm) << mcu;
    // 66.8 mm of outline at 80 mm/s at most.
    EXPECT_GT(lit[0] * job.account.target.periodS(), 66.8 / 80.0) << mcu;
    EXPECT_EQ(lit[0], lit[1]);
    EXPECT_EQ(lit[0], lit[2]);
  }
}

TEST(OwnJobTable, HoldsTheStepsOfThePlanPeriodForPeriodAndReturnsToTheStart) {
  const OwnJob job = test::makeSmallJob({});
  std::vector<Eigen::Vector2i> planned;
  Eigen::Vector2i at = Eigen::Vector2i::Zero();
  for (const auto& op : job.plan.program.ops) {
    if (op[0] == KB_OP_WAIT_MARK || op[0] == KB_OP_END) planned.push_back(at);  // A period of rest.
    if ((op[0] & KB_OP_MOVE) == 0) continue;
    std::size_t next = 1;
    for (int axis = 0; axis < 2; ++axis) {
      if ((op[0] >> axis & 1) != 0) at[axis] += static_cast<std::int8_t>(op[next++]);
    }
    planned.push_back(at);
  }
  const std::vector<Shown> shown = test::periodsIn(job.source, job.table);
  ASSERT_EQ(shown.size(), planned.size());
  for (std::size_t i = 0; i < shown.size(); ++i) ASSERT_EQ(shown[i].steps, planned[i]) << i;
  EXPECT_EQ(shown.back().steps, Eigen::Vector2i(0, 0));
}

TEST(OwnJobTable, AnAxisThatRestsKeepsItsDirection) {
  const OwnJob job = test::makeSmallJob({});
  const std::vector<Shown> shown = test::periodsIn(job.source, job.table);
  int changes = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      if (shown[i].dirs[axis] == shown[i - 1].dirs[axis]) continue;
      ++changes;
      // The axis moves in the new direction before it changes again.
      const int way = shown[i].dirs[axis] == 0 ? 1 : -1;
      const auto moves =
          std::find_if(shown.begin() + static_cast<std::ptrdiff_t>(i), shown.end(),
                       [&](const Shown& p) { return p.steps[axis] != shown[i - 1].steps[axis]; });
      ASSERT_NE(moves, shown.end());
      EXPECT_EQ((moves->steps[axis] - shown[i - 1].steps[axis] > 0) ? 1 : -1, way) << i;
    }
  }
  EXPECT_GT(changes, 8);
}

TEST(OwnJobTable, UnitsThatAreAlikeAreWrittenOnce) {
  const OwnJob three = test::makeSmallJob({});
  EXPECT_LT(three.table.periods, test::periodsIn(three.source, three.table).size() / 2);
}

TEST(OwnJobTable, WhatItDoesNotHaveIsRefusedWithWhatWouldFit) {
  const auto refusalOf = [](auto change) {
    MachineParameters machine = test::smallMachine();
    JobParameters job = test::smallJob();
    Mcs51Controller controller;
    change(machine, job, controller);
    return test::refusal(
        [&] { makeOwnJob("x", makeGcode(test::label(), machine, job), machine, job, controller); });
  };
  EXPECT_THAT(refusalOf([](auto& machine, auto& job, auto&) {
                machine.feed_step_mm = 0.01;
                job.feed_by_controller = true;
              }),
              HasSubstr("drives no feed"));
  EXPECT_THAT(refusalOf([](auto& machine, auto&, auto&) { machine.tracking_delay_s = 4e-3; }),
              HasSubstr("31 can be waited"));
  EXPECT_THAT(refusalOf([](auto&, auto&, auto& controller) { controller.mcu = "z80"; }),
              HasSubstr("--mcu z80: known are 80c51, "));
  const std::string large = refusalOf([](auto& machine, auto& job, auto& controller) {
    machine = test::twoMirror();
    job.pitch_mm = 160.0;
    job.mark_speed_mm_s = 8.0;
    job.belt_speed_mm_s = 2.0;
    controller.mcu = "at89s51";
  });
  EXPECT_THAT(large, HasSubstr("at89s51 has 4096"));
  EXPECT_THAT(large, HasSubstr("--mark-speed"));
}

}  // namespace
}  // namespace kerfbench::planner

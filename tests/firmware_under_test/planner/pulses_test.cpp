// SPDX-License-Identifier: Apache-2.0
// Requirements of drives on PUL and DIR, and the controller's settings for them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/job/pulses.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::refusal;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

DriveNeeds needs(double setup_us, double hold_us, double width_us, double space_us) {
  return {.name = "it",
          .setup_s = setup_us * 1e-6,
          .hold_s = hold_us * 1e-6,
          .width_s = width_us * 1e-6,
          .space_s = space_us * 1e-6};
}

Drives only(const DriveNeeds& drive, int axis = KB_GALVO_X) {
  Drives drives;
  drives[static_cast<std::size_t>(axis)] = drive;
  return drives;
}

Target galvo() {
  Target target;
  target.tick_s = 1e-6;
  target.ticks_per_period = 128;
  target.max_steps = 127;
  target.setup_s = 9 / 16e6;
  target.hold_s = target.width_s = 7 / 16e6;
  target.space_s = 9 / 16e6;
  target.late_s = 0.0;
  return target;
}

TEST(Pulses, NothingIsAskedOfADriveThatNeedsNothing) {
  const PulseSettings settings = pulsesFor({}, {});
  EXPECT_THAT(settings.most_steps, ElementsAre(31, 31, 31, 31, 31));
  EXPECT_THAT(settings.turn_steps, ElementsAre(31, 31, 31, 31, 31));
  EXPECT_EQ(settings.invert_a | settings.invert_c | settings.wide, 0);
}

TEST(Pulses, PolarityIsThatOfItsOwnPins) {
  Drives drives;
  drives[KB_GALVO_Y].falling_edge = true;
  drives[KB_GANTRY_X].dir_low = true;
  drives[KB_FEED].falling_edge = drives[KB_FEED].dir_low = true;
  EXPECT_EQ(pulsesFor({}, drives).invert_a, 0x04 | 0x20);
  EXPECT_EQ(pulsesFor({}, drives).invert_c, 0x03);
}

TEST(Pulses, ALongHoldMakesItTurnAtFewerSteps) {
  const PulseSettings settings = pulsesFor({}, only(needs(5, 10, 2.5, 2.5)));  // DM556
  EXPECT_EQ(settings.most_steps[KB_GALVO_X], 31);
  EXPECT_EQ(settings.turn_steps[KB_GALVO_X], 16) << "the last pulse a tick before the border";
  EXPECT_EQ(settings.turn_steps[KB_GALVO_Y], 31);
}

TEST(Pulses, ASlowDriveGetsLongPulsesFarApart) {
  const PulseSettings settings = pulsesFor({}, only(needs(150, 150, 150, 150)));  // TB6560
  EXPECT_EQ(settings.wide, 1);
  EXPECT_EQ(settings.wide_ticks, 7) << "175 us, less 16.25 by which a tick may be late";
  EXPECT_EQ(settings.most_steps[KB_GALVO_X], 2);
  EXPECT_EQ(settings.turn_steps[KB_GALVO_X], 2);
  EXPECT_EQ(settings.most_steps[KB_GALVO_Y], 31);
}

TEST(Pulses, WhatCannotBeServedIsRefusedWithNumbers) {
  EXPECT_THAT(driveFaults({}, only(needs(5, 5, 500, 5))),
              ElementsAre(HasSubstr("needs PUL active for 500 us")));
  EXPECT_THAT(driveFaults({}, only(needs(5, 5, 500, 5))), ElementsAre(HasSubstr("up to 358.75 us")));
  EXPECT_THAT(driveFaults({}, only(needs(5, 5, 2.5, 900))),
              ElementsAre(HasSubstr("needs PUL idle for 900 us")));
  EXPECT_THAT(driveFaults({}, only(needs(500, 5, 2.5, 5), KB_FEED)),
              ElementsAre(testing::AllOf(HasSubstr("feed: it needs DIR stable for 500 us"),
                                         HasSubstr("gives 363.75"))));
  EXPECT_THAT(driveFaults({}, only(needs(-1, 5, 2.5, 5))), ElementsAre(HasSubstr("must be in 0")));
  EXPECT_THAT(driveFaults(galvo(), only(needs(5, 5, 20, 5))), ElementsAre(HasSubstr("up to 15 us")));
  EXPECT_THAT(driveFaults(galvo(), only(needs(5, 5, 2.5, 2.5))), IsEmpty());
}

/// Brute force: pulses tick by tick as the step engine makes them, each tick late by any amount, DIR changed
/// with the last of a period.
TEST(Pulses, WhateverTheSettingsAllowKeepsTheTimes) {
  for (const Target& target : {Target{}, galvo()}) {
    const double tick = target.tick_s;
    for (const double width : {0.0, 0.4, 1.9, 5.0, 9.0, 40.0, 150.0, 300.0}) {
      for (const double space : {0.0, 0.5, 4.0, 30.0, 150.0}) {
        for (const double stable : {0.0, 0.5, 5.0, 10.0, 40.0, 150.0, 340.0}) {
          const DriveNeeds drive = needs(stable, stable, width, space);
          if (!driveFaults(target, only(drive)).empty()) continue;
          const PulseSettings settings = pulsesFor(target, only(drive));
          const int wide = settings.wide != 0 ? settings.wide_ticks : 0;
          const auto ticksOf = [&](int steps) {
            std::vector<int> ticks;
            int sum = 128;
            for (int t = 1; t <= target.ticks_per_period; ++t) {
              sum += steps * 256 / target.ticks_per_period;
              if (sum >= 256) ticks.push_back(t);
              sum %= 256;
            }
            return ticks;
          };
          for (int steps = 1; steps <= settings.most_steps[0]; ++steps) {
            const std::vector<int> ticks = ticksOf(steps);
            ASSERT_EQ(ticks.size(), static_cast<std::size_t>(steps));
            const double active = wide > 0 ? wide * tick - target.late_s : target.width_s;
            ASSERT_GE(active * 1e6, width - 1e-9);
            for (std::size_t i = 1; i < ticks.size(); ++i) {
              const int apart = ticks[i] - ticks[i - 1];
              ASSERT_GT(apart, wide > 0 ? wide : 0);
              const double idle = wide > 0    ? (apart - wide) * tick - target.late_s
                                  : apart > 1 ? std::max(target.space_s, (apart - 1) * tick - target.late_s)
                                              : target.space_s;
              ASSERT_GE(idle * 1e6, space - 1e-9);
            }
            if (steps > settings.turn_steps[0]) continue;
            const int first = ticks.front();
            const int left = target.ticks_per_period - ticks.back();
            const double setup =
                std::max(target.setup_s, (first - 1) * tick + target.setup_s - target.late_s);
            const double hold = std::max(target.hold_s, left * tick + target.hold_s - target.late_s);
            ASSERT_GE(setup * 1e6, stable - 1e-9) << steps << " of " << target.ticks_per_period;
            ASSERT_GE(hold * 1e6, stable - 1e-9) << steps << " of " << target.ticks_per_period;
          }
        }
      }
    }
  }
}

TEST(Pulses, ASlowDriveSlowsTheJobDownAndAJobThatTurnsTooFastIsRefused) {
  MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  const double fast_s = plan(test::label(), machine, job).unit_time_s;
  machine.drives[KB_GALVO_X] = machine.drives[KB_GALVO_Y] = needs(5, 5, 9, 60);
  const Plan slow = plan(test::label(), machine, job);
  EXPECT_GT(slow.unit_time_s, 2.0 * fast_s);
  const int most = pulsesFor(machine.target, machine.drives).most_steps[0];
  EXPECT_LT(most, 12);
  EXPECT_LE(std::ranges::max(test::play(slow.program, machine, job).periods, {}, &test::Period::largest_steps)
                .largest_steps,
            most);

  machine.drives[KB_GALVO_X] = machine.drives[KB_GALVO_Y] = needs(5, 330, 2.5, 2.5);
  job.acceleration_mm_s2 = 200000;
  // The mirrors make 9 steps a period from one to the next.
  const dieline::Dieline small = test::dielineOf({test::arc(-10.0, 0.0, 0.5, 0.0, 360.0)});
  EXPECT_THAT(refusal([&] { plan(small, machine, job); }), HasSubstr("DIR must be stable: accelerate less"));
  machine.drives[KB_GALVO_X] = needs(5, 5, 900, 2.5);
  EXPECT_THAT(refusal([&] { plan(test::label(), machine, job); }),
              HasSubstr("galvo_x: it needs PUL active for 900 us"));
}

}  // namespace
}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "firmware_under_test/planner/program/program.h"
#include "libraries.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;

JobParameters slowJob() {
  JobParameters job = test::mirrorJob();
  job.mark_speed_mm_s = 100.0;
  job.belt_speed_mm_s = 0.0;
  return job;
}

/// Machine with room for a carton at rest.
MachineParameters wideMachine() {
  MachineParameters machine = test::twoMirror();
  for (int i = 0; i < 2; ++i) {
    machine.field_min_mm[i] = -200.0;
    machine.field_max_mm[i] = 200.0;
  }
  return machine;
}

std::vector<Sample> marksOf(const std::string& gcode, const JobParameters& job) {
  std::vector<Sample> marks;
  const auto unit = planUnit(unitOf(readGcode(gcode)), job, Axes(wideMachine(), {}), job.belt_speed_mm_s);
  for (const Block& block : unit->blocks)
    for (const Sample& sample : block.samples)
      if (sample.marked_mm > 0.0) marks.push_back(sample);
  return marks;
}

std::vector<int> bytesOf(const Plan& plan, const JobParameters& job) {
  std::vector<int> bytes;
  for (const test::Period& period : test::play(plan.program, wideMachine(), job).periods)
    if (period.power >= 0) bytes.push_back(period.power);
  return bytes;
}

TEST(PowerOfAJob, WithoutAModelItIsProportionalByteForByte) {
  const MachineParameters machine = wideMachine();
  const JobParameters job = slowJob();
  const Plan plan = planner::plan(test::carton(), machine, job);
  const std::vector<Sample> marks = marksOf(plan.gcode, job);
  const std::vector<int> bytes = bytesOf(plan, job);
  ASSERT_EQ(marks.size(), bytes.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double power_w = job.cut_energy_j_per_mm * marks[i].marked_mm / Target{}.periodS();
    ASSERT_EQ(bytes[i], std::lround(std::min(power_w / machine.full_power_w * 255.0, 255.0))) << i;
  }
}

TEST(PowerOfAJob, AModelChangesPowerAndNothingElse) {
  const MachineParameters machine = wideMachine();
  JobParameters job = slowJob();
  const Plan before = planner::plan(test::carton(), machine, job);
  job.power = test::steelModel(0.2);
  const Plan after = planner::plan(test::carton(), machine, job);
  EXPECT_EQ(before.gcode, after.gcode);
  EXPECT_EQ(before.program.config, after.program.config);
  const test::Played a = test::play(before.program, machine, job);
  const test::Played b = test::play(after.program, machine, job);
  ASSERT_EQ(a.periods.size(), b.periods.size());
  int changed = 0;
  for (std::size_t i = 0; i < a.periods.size(); ++i) {
    ASSERT_EQ(a.periods[i].to_W_mm, b.periods[i].to_W_mm);
    ASSERT_EQ(a.periods[i].power < 0, b.periods[i].power < 0);
    changed += a.periods[i].power != b.periods[i].power ? 1 : 0;
  }
  EXPECT_GT(changed, 100);
}

TEST(PowerOfAJob, EachProcessGetsItsDepth) {
  JobParameters job = slowJob();
  job.power = std::make_shared<PowerModel>(test::steel(), test::tube(), PowerWish{0.2, 0.2, 0.07});
  const Plan plan = planner::plan(test::carton(), wideMachine(), job);
  const std::vector<Sample> marks = marksOf(plan.gcode, job);
  const std::vector<int> bytes = bytesOf(plan, job);
  ASSERT_EQ(marks.size(), bytes.size());
  int cuts = 0, creases = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double speed = marks[i].marked_mm / marks[i].z / Target{}.periodS();
    if (speed < 90.0) continue;
    const double depth = job.power->depthBy(job.power->powerOf(std::uint8_t(bytes[i])), speed);
    const double wanted = marks[i].z == 1.0 ? 0.2 : 0.07;
    ++(marks[i].z == 1.0 ? cuts : creases);
    EXPECT_NEAR(depth, wanted, 0.015 * wanted) << i;
  }
  EXPECT_GT(cuts, 100);
  EXPECT_GT(creases, 100);
}

TEST(PowerOfAJob, IsRefusedWhereTheLaserIsTooWeakAndSaysHowDeepItGets) {
  JobParameters job = slowJob();
  job.power = test::steelModel(0.2);
  const MachineParameters machine = wideMachine();
  const std::string gcode = makeGcode(test::label(), machine, job);
  EXPECT_TRUE(checkJob(gcode, machine, job).errors.empty());
  job.mark_speed_mm_s = 149.0;
  EXPECT_TRUE(checkJob(gcode, machine, job).errors.empty()) << "149.5 mm/s is the highest";
  job.mark_speed_mm_s = 200.0;
  const CheckResult result = checkJob(gcode, machine, job);
  EXPECT_FALSE(result.solution);
  ASSERT_FALSE(result.errors.empty());
  EXPECT_THAT(result.errors.front(), HasSubstr("CO2 tube 80 W gives 78 W, enough for 0.16"));
  EXPECT_THAT(result.errors.front(), HasSubstr("mark at 149.5 mm/s at most"));
  EXPECT_THROW((void)planFromGcode(gcode, machine, job), PlanError);
}

TEST(PowerOfAJob, WarnsWhereTheLeastPowerIsTooMuch) {
  JobParameters job = slowJob();
  const MachineParameters machine = wideMachine();
  const std::string gcode = makeGcode(test::label(), machine, job);
  EXPECT_TRUE(checkJob(gcode, machine, job).warnings.empty());
  job.power = test::steelModel(0.2);
  const CheckResult result = checkJob(gcode, machine, job);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_THAT(result.warnings.front(), HasSubstr("Z1: below 7.7 mm/s CO2 tube 80 W gives no less than 4 W"));
  LaserTube steady = test::tube();
  steady.power = Curve({{0.0, 0.0}, {100.0, 80.0}});
  steady.least_w = 0.0;
  job.power = std::make_shared<PowerModel>(test::steel(), steady, PowerWish{0.2, 0.2, std::nullopt});
  EXPECT_TRUE(checkJob(gcode, machine, job).warnings.empty()) << "a laser without a least power";
}

TEST(PowerOfAJob, NeedsNoCutEnergy) {
  JobParameters job = slowJob();
  job.cut_energy_j_per_mm = 0.0;
  EXPECT_FALSE(jobIssues(wideMachine(), job).empty());
  job.power = test::steelModel(0.2);
  EXPECT_TRUE(jobIssues(wideMachine(), job).empty());
}

TEST(PowerOfAJob, TheLoopIsHeldAgainstTheControllerThatIsPlannedFor) {
  MachineParameters machine = wideMachine();
  machine.tracking_delay_s = 0.19e-3;
  machine.power_delay_s = 2e-3;
  JobParameters job = slowJob();
  job.power = test::steelModel(0.2);
  job.power_loop = true;
  machine.power_quantum_j = job.power->laser().power.greatest().y * 0.8e-3 / (2.0 * 60.0);
  EXPECT_THAT(jobIssues(machine, job), ::testing::IsEmpty());
  machine.laser_lag_s = 9e-3;  // The AVR looks back over 352 ticks of 25 us.
  EXPECT_THAT(jobIssues(machine, job), ::testing::ElementsAre(HasSubstr("in 0 … 8.75 together")));
  machine.laser_lag_s = 0.0;
  machine.target.tick_s = 1e-6;
  machine.target.ticks_per_period = 128;
  machine.target.longest_delay_ticks = 65535;
  EXPECT_THAT(jobIssues(machine, job),
              ::testing::ElementsAre(HasSubstr("in 0 … 0.35 together"), HasSubstr("9.6 edges in a period")));
}

}  // namespace
}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/controller/protocol.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::play;
using test::Played;
using ::testing::HasSubstr;

struct Shape {
  const char* name;
  dieline::Dieline dieline;
  double belt_mm_s;
  bool gantry;
};

std::vector<Shape> shapes() {
  const dieline::Dieline circle = test::dielineOf({test::arc(-30, 10, 15, 90, 360)});
  dieline::Entity ellipse;
  ellipse.curve = dieline::EllipseCurve{{-30, 0}, {25, 5}, {-2, 10}, 0.0, 6.283185307179586};
  return {{"label at rest", test::label(), 0.0, false},
          {"label at 100 mm/s", test::label(), 100.0, false},
          {"label at 205 mm/s", test::label(), 205.0, false},
          {"circle at 300 mm/s", circle, 300.0, false},
          {"ellipse at 120 mm/s", test::dielineOf({ellipse}), 120.0, false},
          {"carton at 9 mm/s", test::carton(), 9.0, false},
          {"carton at 50 mm/s", test::carton(), 50.0, false},
          {"carton on a gantry", test::carton(), 60.0, true},
          {"strip at rest", test::strip(), 0.0, true},
          {"strip at 200 mm/s", test::strip(), 200.0, true}};
}

class EveryShape : public ::testing::TestWithParam<int> {
 protected:
  Shape shape_{shapes()[std::size_t(GetParam())]};
  MachineParameters machine_{shape_.gantry ? test::gantry() : test::twoMirror()};
  JobParameters job_{[this] {
    JobParameters job = shape_.gantry ? test::gantryJob() : test::mirrorJob();
    job.belt_speed_mm_s = shape_.belt_mm_s;
    return job;
  }()};
};

TEST_P(EveryShape, BurnsTheDielineAndNothingElse) {
  const Plan plan = planner::plan(shape_.dieline, machine_, job_);
  const Played played = play(plan.program, machine_, job_);
  EXPECT_EQ(played.error, "");
  EXPECT_TRUE(played.ended);
  EXPECT_LT(test::worstDeviationMm(played, shape_.dieline, job_), 0.015) << shape_.name;
  EXPECT_LT(test::worstGapMm(played, shape_.dieline, job_, 0), 0.015) << shape_.name;
}

TEST_P(EveryShape, StaysInTheFieldAndWithinTheSteps) {
  const Played played = play(planner::plan(shape_.dieline, machine_, job_).program, machine_, job_);
  for (const test::Period& period : played.periods) {
    EXPECT_LE(period.largest_steps, 29) << "some are kept for the follow correction";
    for (int i = 0; i < 2; ++i) {
      // The slack is half a step of rounding.
      EXPECT_GE(period.to_W_mm[i], machine_.field_min_mm[i] - 0.007);
      EXPECT_LE(period.to_W_mm[i], machine_.field_max_mm[i] + 0.007);
    }
  }
}

TEST_P(EveryShape, EnergyPerLengthIsConstantAlongMarks) {
  const Played played = play(planner::plan(shape_.dieline, machine_, job_).program, machine_, job_);
  // The window is 24 periods, so that the rounding of single steps does not hide the effect.
  constexpr std::size_t kWindow = 24;
  int seen = 0;
  for (std::size_t i = 0; i + kWindow <= played.periods.size(); i += 4) {
    double energy_j = 0.0;
    double way_mm = 0.0;
    bool slow = false;
    int least = 255;
    for (std::size_t k = i; k < i + kWindow; ++k) {
      const test::Period& period = played.periods[k];
      least = std::min(least, period.power);
      energy_j += period.power / 255.0 * machine_.full_power_w * 0.8e-3;
      const double step_mm = (period.to_S_mm - period.from_S_mm).norm();
      slow = slow || period.power / 255.0 * machine_.full_power_w / job_.cut_energy_j_per_mm <
                         0.2 * job_.mark_speed_mm_s;
      way_mm += step_mm;
    }
    if (least < 0 || slow) continue;
    const double per_mm = energy_j / way_mm / job_.cut_energy_j_per_mm;
    const bool half = per_mm < 0.75;
    EXPECT_NEAR(per_mm, half ? 0.5 : 1.0, half ? 0.015 * 2 : 0.03) << shape_.name << " period " << i;
    ++seen;
  }
  EXPECT_GT(seen, 5);
}

TEST_P(EveryShape, TheGateIsOpenForTheWayOfTheMarksOnly) {
  const Plan plan = planner::plan(shape_.dieline, machine_, job_);
  double burnt_mm = 0.0;
  for (const test::Period& period : play(plan.program, machine_, job_).periods) {
    if (period.power >= 0) burnt_mm += (period.to_S_mm - period.from_S_mm).norm();
  }
  // Steps make the path a little longer.
  EXPECT_NEAR(burnt_mm, plan.cut_length_mm, 0.02 * plan.cut_length_mm);
}

/// Lowest or highest step of an axis in KB_CONFIG.
std::int32_t fieldEnd(const Program& program, int axis, bool highest) {
  const std::size_t at =
      KB_CONFIG_LEN - 8U * KB_AXES + 4U * static_cast<unsigned>(axis) + (highest ? 4U * KB_AXES : 0U);
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{program.config.at(at + i)} << (8 * i);
  return static_cast<std::int32_t>(value);
}

// The firmware would stop a program that leaves the field.
TEST_P(EveryShape, ALitPeriodEndsWithinTheFieldThatIsTold) {
  const Program program = planner::plan(shape_.dieline, machine_, job_).program;
  std::array<long, KB_AXES> at{};
  int lit = 0;
  for (const std::vector<std::uint8_t>& op : program.ops) {
    if ((op[0] & KB_OP_MOVE) == 0) continue;
    std::size_t byte = 1;
    for (unsigned axis = 0; axis < KB_AXES; ++axis)
      if ((op[0] & 1U << axis) != 0) at.at(axis) += static_cast<std::int8_t>(op.at(byte++));
    if ((op[0] & KB_OP_POWER) == 0) continue;
    ++lit;
    for (int axis = 0; axis < KB_AXES; ++axis) {
      ASSERT_GE(at.at(static_cast<std::size_t>(axis)), fieldEnd(program, axis, false)) << axis;
      ASSERT_LE(at.at(static_cast<std::size_t>(axis)), fieldEnd(program, axis, true)) << axis;
    }
  }
  EXPECT_GT(lit, 100);
}

TEST_P(EveryShape, PlansTheSameBytesAgain) {
  EXPECT_EQ(planner::plan(shape_.dieline, machine_, job_).program.ops,
            planner::plan(shape_.dieline, machine_, job_).program.ops);
}

INSTANTIATE_TEST_SUITE_P(Planner, EveryShape, ::testing::Range(0, static_cast<int>(shapes().size())),
                         [](const auto& shape) {
                           std::string name = shapes()[std::size_t(shape.param)].name;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

std::string refusal(const dieline::Dieline& dieline, const MachineParameters& machine,
                    const JobParameters& job) {
  try {
    planner::plan(dieline, machine, job);
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

TEST(Config, LaserWaitsForTheMirrorsAndTheBeltIsCounted) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 200.0;
  const auto plan = planner::plan(test::label(), test::twoMirror(), job);
  const auto& config = plan.program.config;
  ASSERT_EQ(config.size(), std::size_t(KB_CONFIG_LEN));
  // 200 mm/s * 0.8 ms / 0.01 mm = 16 counts.
  EXPECT_EQ(config[0] | config[1] << 8 | config[2] << 16 | config[3] << 24, 16 << 16);
  EXPECT_EQ(config[4], 8);  // 0.19 ms in ticks of 25 us
  EXPECT_EQ(config[5], 8);
  const int most = config[7] | config[8] << 8 | config[9] << 16 | config[10] << 24;
  EXPECT_EQ(most, std::lround(plan.belt_stop_mm_s * 0.8e-3 / 0.01 * 65536.0));
  EXPECT_GE(plan.belt_stop_mm_s, plan.max_belt_speed_mm_s);
  EXPECT_GE(plan.belt_stop_mm_s, 1.02 * job.belt_speed_mm_s);
}

TEST(Config, TheFieldIsToldInStepsAndAWaverAlongTheBelt) {
  const MachineParameters machine = test::gantry();
  JobParameters job = test::gantryJob();
  for (const bool moving : {true, false}) {
    job.belt_speed_mm_s = moving ? 200.0 : 0.0;
    const Program program = planner::plan(test::strip(), machine, job).program;
    for (int i = 0; i < 2; ++i) {
      const double waver_mm = i == 0 && moving ? 0.5 : 0.0;
      const double low = (machine.field_min_mm[i] - waver_mm) / machine.gantry_step_mm;
      const double high = (machine.field_max_mm[i] + waver_mm) / machine.gantry_step_mm;
      EXPECT_NEAR(fieldEnd(program, KB_GANTRY_X + i, false), low, 1.0);
      EXPECT_NEAR(fieldEnd(program, KB_GANTRY_X + i, true), high, 1.0);
    }
    EXPECT_EQ(fieldEnd(program, KB_FEED, true), std::numeric_limits<std::int32_t>::max());
  }
}

// The field of mirrors is a box that holds it: the y mirror is largest in the corners, the x mirror where y
// is 0.
TEST(Config, OfMirrorsTheFieldIsABoxAroundIt) {
  const MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 100.0;
  const Program program = planner::plan(test::label(), machine, job).program;
  constexpr double kWaverMm = 0.5;
  const auto step = [&](double mm, double throw_mm) {
    return 0.5 * std::atan(mm / throw_mm) / machine.mirror_step_rad;
  };
  const double reach_mm = machine.throw_mm + machine.mirror_spacing_mm;
  EXPECT_NEAR(fieldEnd(program, KB_GALVO_X, true), step(machine.field_max_mm[0] + kWaverMm, reach_mm), 2.0);
  EXPECT_NEAR(fieldEnd(program, KB_GALVO_X, false), step(machine.field_min_mm[0] - kWaverMm, reach_mm), 2.0);
  EXPECT_NEAR(fieldEnd(program, KB_GALVO_Y, true), step(machine.field_max_mm[1], machine.throw_mm), 1.0);
  EXPECT_NEAR(fieldEnd(program, KB_GALVO_Y, false), step(machine.field_min_mm[1], machine.throw_mm), 1.0);
}

TEST(Refusal, AWeakLaserIsNamedWithTheSpeedItCouldDo) {
  JobParameters job = test::mirrorJob();
  job.cut_energy_j_per_mm = 1.0;
  const std::string why = refusal(test::label(), test::twoMirror(), job);
  EXPECT_THAT(why, HasSubstr("E6"));
  EXPECT_THAT(why, HasSubstr("the laser has 200 W"));
  EXPECT_THAT(why, HasSubstr("mark at 198 mm/s at most"));
}

TEST(Refusal, AnEntityOutsideTheFieldIsNamed) {
  const dieline::Dieline wide = test::dielineOf({test::line(-10, -90, -10, 20), test::line(-20, 0, -20, 85)});
  const std::string why = refusal(wide, test::twoMirror(), test::mirrorJob());
  EXPECT_THAT(why, HasSubstr("E0"));
  EXPECT_THAT(why, HasSubstr("E1"));
  EXPECT_THAT(refusal(test::carton(), test::twoMirror(), test::mirrorJob()), HasSubstr("x_W -142"));
}

TEST(Refusal, AllWrongParametersAtOnce) {
  MachineParameters machine = test::twoMirror();
  machine.throw_mm = 0.0;
  machine.field_min_mm[1] = 90.0;
  JobParameters job = test::mirrorJob();
  job.mark_speed_mm_s = NAN;
  job.units = 0;
  const std::string why = refusal(test::label(), machine, job);
  for (const char* name : {"throw_mm", "field along y", "mark_speed_mm_s", "units"})
    EXPECT_THAT(why, HasSubstr(name));
}

TEST(Refusal, NothingToCut) {
  dieline::Dieline dieline = test::label();
  for (dieline::Entity& entity : dieline.entities) entity.process = dieline::Process::kIgnore;
  EXPECT_THAT(refusal(dieline, test::twoMirror(), test::mirrorJob()), HasSubstr("nothing to cut"));
}

}  // namespace
}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
// Fast mode compared with the reference, and the reference's shortcut with a full solution.
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "tests/twin/cutter/model_rigs.h"
#include "twin/machine/fast_solver.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::twin {
namespace {

struct Case {
  const char* name;
  MachineDescription machine;
  WebDescription web;
  std::vector<std::pair<Axis, std::vector<StepEdge>>> pulses;
  double until_s{0.12};
  double least_travel_mm{1.0};  ///< Least travel, as a proof of motion.
  bool loses_steps{};
};
std::ostream& operator<<(std::ostream& out, const Case& of) { return out << of.name; }

WebDescription stoppingWeb() {
  WebDescription web = lineWeb();
  web.belt_speed_mm_s = 400.0;
  web.belt_speed_changes = {{0.02, 400.0}, {0.03, 0.0}, {0.07, 0.0}, {0.09, -300.0}};
  return web;
}

Case mirrors(const char* name, MachineDescription machine, double rate_hz) {
  const auto forth = trapezoid(1e-3, 1200, rate_hz, 1e9);
  return {name,
          std::move(machine),
          lineWeb(),
          {{Axis::kGalvoX, forth},
           {Axis::kGalvoX, trapezoid(endOf(forth) + 1e-5, -2000, rate_hz, 1e9)},
           {Axis::kGalvoY, trapezoid(5e-3, -1500, 0.7 * rate_hz, 1e9)}}};
}

Case slides(const char* name, MachineDescription machine, double rate_hz, double ramp_hz_s) {
  const auto forth = trapezoid(1e-3, 800, rate_hz, ramp_hz_s);
  return {name,
          std::move(machine),
          lineWeb(),
          {{Axis::kGantryX, forth},
           {Axis::kGantryX, trapezoid(endOf(forth) + 1e-3, -500, rate_hz, ramp_hz_s)},
           {Axis::kGantryY, trapezoid(4e-3, -700, 0.8 * rate_hz, 2.0 * ramp_hz_s)}},
          0.25};
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back(mirrors("mirrors", twoMirror(), 40e3));
  all.push_back(mirrors("limited mirrors", limitedMirrors(), 200e3));
  all.push_back(slides("gantry that shakes its frame", gantryOnFeet(), 40e3, 1e6));
  MachineDescription worn = gantryOnFeet();
  worn.squareness_rad = 1e-3;
  for (AxisDescription* axis : {&worn.gantry_x, &worn.gantry_y}) {
    axis->friction = {20.0, 10.0, 1e-6};
    axis->backlash = 0.02;
    std::get<ServoDescription>(axis->drive).max_torque = 2.0;
    std::get<ServoDescription>(axis->drive).max_speed = 100.0;
  }
  all.push_back(slides("gantry with backlash, friction and limits", worn, 40e3, 1e6));
  all.push_back(slides("steppers within their torque", stepperGantry(), 30e3, 3e5));
  all.push_back(slides("steppers beyond their torque", stepperGantry(), 80e3, 5e6));
  all.back().loses_steps = true;
  MachineDescription dragged = twoMirror();
  dragged.belt.bed_friction = {5.0, 20.0, 1e-6};
  dragged.belt.sheet_drag_n = {-0.1, 0.08};
  all.push_back({"line that stops and turns, sheet dragged aside", dragged, stoppingWeb(), {}, 0.15});
  MachineDescription fed = twoMirror();
  fed.belt.feed.drive = nema23Stepper();
  fed.belt.bed_friction = {3.0, 20.0, 1e-6};
  const auto start = trapezoid(1e-3, 800, 30e3, 2e6);
  all.push_back({"feed by a stepper that starts and stops with slip",
                 fed,
                 fedWeb(),
                 {{Axis::kFeed, start}, {Axis::kFeed, trapezoid(endOf(start) + 0.02, -300, 20e3, 2e6)}}});
  MachineDescription loose = twoMirror();
  loose.belt.feed.backlash = 1e-3;
  loose.belt.feed.friction = {0.02, 1e-3, 1e-5};
  all.push_back({"feed by a servo with backlash",
                 loose,
                 fedWeb(),
                 {{Axis::kFeed, start}, {Axis::kFeed, trapezoid(endOf(start) + 0.02, -300, 20e3, 2e6)}}});
  return all;
}

class FastMode : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Motions, FastMode, testing::ValuesIn(cases()), [](const auto& of) {
  std::string name = of.param.name;
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == ','; }, '_');
  return name;
});

TEST_P(FastMode, ManyStepsAtOnceAreThoseOneByOne) {
  const Case& of = GetParam();
  MachineModel single(of.machine, of.web, Fidelity::kFast);
  MachineModel many(of.machine, of.web, Fidelity::kFast);
  for (const auto& [axis, edges] : of.pulses) {
    feed(single, axis, edges);
    feed(many, axis, edges);
  }
  const auto end = static_cast<std::uint64_t>(of.until_s / MachineModel::kStep_s);
  std::uint64_t done = 0;
  for (std::uint64_t steps = 1; done < end; steps = steps % 97 + 13) {
    for (std::uint64_t i = 0; i < steps; ++i) single.run(done + i, 1);
    many.run(done, steps);
    done += steps;
    const MachinePose a = single.pose();
    const MachinePose b = many.pose();
    ASSERT_EQ(a.time_s, b.time_s);
    ASSERT_EQ(a.belt_travel_mm, b.belt_travel_mm) << done;
    ASSERT_EQ(a.sheet_slip_mm, b.sheet_slip_mm) << done;
    ASSERT_EQ(a.mirror_rad, b.mirror_rad) << done;
    ASSERT_EQ(a.gantry_mm, b.gantry_mm) << done;
    ASSERT_EQ(single.rollerAcceleration_mm_s2(), many.rollerAcceleration_mm_s2()) << done;
    ASSERT_EQ(single.sheetAcceleration_mm_s2(), many.sheetAcceleration_mm_s2()) << done;
    ASSERT_EQ(single.gantrySpeed_mm_s(), many.gantrySpeed_mm_s()) << done;
  }
  ASSERT_EQ(single.lostSteps().size(), many.lostSteps().size());
  for (std::size_t i = 0; i < single.lostSteps().size(); ++i) {
    EXPECT_EQ(single.lostSteps()[i].time_s, many.lostSteps()[i].time_s);
    EXPECT_EQ(single.lostSteps()[i].full_steps, many.lostSteps()[i].full_steps);
  }
}

TEST_P(FastMode, AgreesWithTheReference) {
  const Case& of = GetParam();
  MachineModel reference(of.machine, of.web, Fidelity::kReference);
  MachineModel fast(of.machine, of.web, Fidelity::kFast);
  for (const auto& [axis, edges] : of.pulses) {
    feed(reference, axis, edges);
    feed(fast, axis, edges);
  }
  double spot_mm = 0.0;
  double board_mm = 0.0;
  double travel_mm = 0.0;
  runModel(reference, of.until_s, [&](double t) {
    fast.run(static_cast<std::uint64_t>(std::llround(t / MachineModel::kStep_s)) - 1, 1);
    const MachinePose a = reference.pose();
    const MachinePose b = fast.pose();
    const auto spot_a = reference.spot();
    const auto spot_b = fast.spot();
    ASSERT_TRUE(spot_a && spot_b);
    spot_mm = std::max(spot_mm, (spot_a->p_WQ_mm - spot_b->p_WQ_mm).norm());
    board_mm = std::max({board_mm, std::abs(a.belt_travel_mm - b.belt_travel_mm),
                         std::abs(a.roller_mm - b.roller_mm), (a.sheet_slip_mm - b.sheet_slip_mm).norm()});
    travel_mm = std::max({travel_mm, spot_a->p_WQ_mm.norm(), std::abs(a.belt_travel_mm)});
  });
  RecordProperty("spot_um", std::to_string(1e3 * spot_mm));
  RecordProperty("board_um", std::to_string(1e3 * board_mm));
  EXPECT_GT(travel_mm, of.least_travel_mm);
  EXPECT_EQ(!reference.lostSteps().empty(), of.loses_steps);
  ASSERT_EQ(fast.lostSteps().size(), reference.lostSteps().size());
  for (std::size_t i = 0; i < fast.lostSteps().size(); ++i) {
    const LostSteps& a = reference.lostSteps()[i];
    const LostSteps& b = fast.lostSteps()[i];
    EXPECT_EQ(a.axis, b.axis);
    EXPECT_EQ(a.full_steps, b.full_steps);
    EXPECT_NEAR(a.time_s, b.time_s, 2.0 * MachineModel::kStep_s);
  }
  if (of.loses_steps) return;  // Beyond pull-out a rotor's path is chaos; its teeth are counted above.
  EXPECT_LT(spot_mm, 1e-4);
  EXPECT_LT(board_mm, 1e-4);
}

TEST_P(FastMode, TheReferenceIsTheSameWithArticulatedBodiesAtEveryStage) {
  const Case& of = GetParam();
  const MachineMechanism machine = mechanismOf(of.machine, of.web);
  const auto mechanism = std::make_shared<const Mechanism>(machine.description);
  using Accelerations = ReferenceSolver::Accelerations;
  ReferenceSolver once(mechanism, MachineModel::kStep_s, Accelerations::kOnceAStep);
  ReferenceSolver each(mechanism, MachineModel::kStep_s, Accelerations::kEveryStage);
  std::vector<PulseCommand> commands;
  for (const auto& drive : machine.pulse_drives) {
    commands.emplace_back(drive.motor_per_step);
    for (const auto& [axis, edges] : of.pulses) {
      if (axis != drive.axis) continue;
      auto& incoming = commands.back().incoming();
      incoming.insert(incoming.end(), edges.begin(), edges.end());
    }
  }
  std::vector<DriveCommand> inputs(machine.description.drives.size());
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double begin_s = i * MachineModel::kStep_s;
    for (std::size_t k = 0; k < commands.size(); ++k) {
      const double mean = commands[k].meanOver(begin_s, begin_s + MachineModel::kStep_s);
      inputs[k] = {mean, mean, mean};
    }
    once.step(begin_s, inputs);
    each.step(begin_s, inputs);
    for (std::size_t k = 0; k < once.q().size(); ++k) {
      worst = std::max(worst, std::abs(once.q()[k] - each.q()[k]));
    }
  }
  EXPECT_LT(worst, 1e-12);  // Limit in m and rad.
}

}  // namespace
}  // namespace kerfbench::twin

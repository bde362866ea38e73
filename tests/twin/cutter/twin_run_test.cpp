// SPDX-License-Identifier: Apache-2.0
// Results of a run besides the burn: lost steps, poses, the power monitor, a model that diverges.
#include <cmath>
#include <stdexcept>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "twin/machine/divergence.h"

namespace kerfbench::twin {
namespace {

constexpr Tick kQuantum = 8000;

TEST(TwinRun, ThePoseIsThatOfTheLastWholeStep) {
  Twin twin(twoMirror(), lineWeb(), kRate);
  twin.advance(ticks(0.0123456), {});
  EXPECT_NEAR(twin.pose().time_s, 0.01234, 1e-12);
  EXPECT_NEAR(twin.pose().belt_travel_mm, 60.0 * 0.01234, 1e-9);
  EXPECT_NEAR(twin.pose().roller_mm, 60.0 * 0.01234, 1e-9);
  EXPECT_NEAR(twin.pose().sheet_slip_mm.norm(), 0.0, 1e-12);
}

TEST(TwinRun, StepsThatAStepperLosesAreTold) {
  MachineDescription machine = gantry();
  StepperDescription stepper;
  stepper.holding_torque_nm = 0.4;
  stepper.damping_nm_s = 1e-3;
  machine.gantry_y.drive = stepper;
  machine.gantry_y.step = 40.0 / 3200.0;  // The step is a sixteenth of a full step.
  Pins pins(machine.signals);
  // The start is from rest to 20 turns a second: no stepper follows.
  pins.steps(Signal::kGantryYPul, 1e-3, 3200, 15.6e-6, true);
  Twin twin(machine, lineWeb(), kRate);
  run(twin, pins.events(), 0, ticks(0.08), kQuantum);
  ASSERT_FALSE(twin.lostSteps().empty());
  EXPECT_EQ(twin.lostSteps()[0].axis, "gantry_y");
  EXPECT_GT(twin.lostSteps()[0].time_s, 1e-3);
  EXPECT_LT(twin.pose().gantry_mm.y(), 35.0);
}

TEST(TwinRun, AModelThatDivergesSaysSo) {
  MachineDescription machine = twoMirror();
  // At 100 m/s a roller as thin as a hair would turn faster than anything can.
  machine.belt.roller_radius_mm = 0.05;
  WebDescription web = lineWeb();
  web.belt_speed_mm_s = 9e4;
  Twin twin(machine, web, kRate);
  try {
    twin.advance(ticks(0.01), {});
    FAIL();
  } catch (const DivergenceError& error) {
    EXPECT_NEAR(error.time_s(), 1e-5, 1e-9);
    EXPECT_THAT(error.joint(), testing::HasSubstr("roller"));
  }
}

MachineDescription monitored() {
  MachineDescription machine = twoMirror();
  machine.signals.assign(Signal::kPowerMonitor, {5, 1});
  machine.power_monitor.quantum_j = 2e-3;
  return machine;
}

std::vector<SensorEdge> monitorEdges(const MachineDescription& machine, Tick quantum, double end_s,
                                     double* emitted_j = nullptr) {
  Pins pins(machine.signals);
  pins.set(1e-4, Signal::kLaserPwm, true);
  pins.set(5.0037e-3, Signal::kLaserGate, true);
  pins.set(35.002e-3, Signal::kLaserGate, false);
  Twin twin(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  std::vector<SensorEdge> edges;
  run(twin, pins.events(), 0, ticks(end_s), quantum, [&](Tick from, Tick until, const auto& all) {
    for (const SensorEdge& e : all) {
      EXPECT_GT(e.tick, from);
      EXPECT_LE(e.tick, until);
      if (e.signal == Signal::kPowerMonitor) edges.push_back(e);
    }
  });
  if (emitted_j != nullptr) *emitted_j = twin.truth().emitted_j;
  return edges;
}

TEST(TwinRun, ThePowerMonitorCountsTheEnergyAndLagsByItsDelay) {
  const auto machine = monitored();
  double emitted_j = 0.0;
  const auto edges = monitorEdges(machine, kQuantum, 0.05, &emitted_j);
  EXPECT_EQ(edges.size(), static_cast<std::size_t>(emitted_j / 2e-3));
  // The n-th quantum of 100 W through a tube of 20 us is emitted 20 us late.
  const double at_s = 5.0037e-3 + 20e-6 + 100.0 * 2e-3 / 100.0 + machine.power_monitor.delay_s;
  EXPECT_NEAR(kRate.seconds(edges[99].tick), at_s, 2e-7);
}

TEST(TwinRun, ThePowerMonitorsEdgesDoNotDependOnTheQuantum) {
  const auto machine = monitored();
  const Twin twin(machine, lineWeb(), kRate);
  EXPECT_NEAR(twin.longestQuantum_s(), machine.power_monitor.delay_s - 10e-6, 1e-12);
  const auto reference = monitorEdges(machine, kQuantum, 0.05);
  ASSERT_GT(reference.size(), 1000U);
  for (const Tick quantum : {Tick{1600}, Tick{1237}, ticks(0.98e-3)}) {
    const auto edges = monitorEdges(machine, quantum, 0.05);
    ASSERT_EQ(edges.size(), reference.size());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      ASSERT_EQ(edges[i].tick, reference[i].tick) << i;
      ASSERT_EQ(edges[i].level, reference[i].level) << i;
    }
  }
}

TEST(TwinRun, WithoutAPinThePowerMonitorIsSilent) {
  EXPECT_TRUE(monitorEdges(twoMirror(), kQuantum, 0.05).empty());
  EXPECT_TRUE(std::isinf(Twin(twoMirror(), lineWeb(), kRate).longestQuantum_s()));
}

TEST(TwinRun, TheMarkSensorSeesTheSheetAndTheEncoderTheRoller) {
  MachineDescription machine = twoMirror();
  machine.belt.sheet_drag_n = {-0.32, 0.0};  // Friction holds 0.294 N: the sheet stays behind.
  Twin twin(machine, lineWeb(), kRate, {.fidelity = Fidelity::kFast});
  double mark_s = -1.0;
  QuadratureCounter counter;
  double sheet_mm = 0.0;
  double sheet_at_mark_mm = -1.0;
  run(twin, {}, 0, ticks(0.2), kQuantum, [&](Tick from, Tick until, const auto& edges) {
    const MachinePose pose = twin.pose();
    const double after_mm = pose.belt_travel_mm + pose.sheet_slip_mm.x();
    for (const SensorEdge& e : edges) {
      if (e.signal == Signal::kPrintMark && mark_s < 0.0) {
        mark_s = kRate.seconds(e.tick);
        const double share = static_cast<double>(e.tick - from) / static_cast<double>(until - from);
        sheet_at_mark_mm = sheet_mm + share * (after_mm - sheet_mm);
      } else {
        counter.apply(e);
      }
    }
    sheet_mm = after_mm;
  });
  // The first mark would come after 50 ms at 60 mm/s; with 0.026 N on 0.05 kg it comes after 73.
  EXPECT_NEAR(mark_s, 0.073, 0.002);
  EXPECT_NEAR(sheet_at_mark_mm, 3.0, 5e-4);
  EXPECT_LT(sheet_mm, 11.0);
  EXPECT_NEAR(static_cast<double>(counter.count()) * 0.01, twin.pose().roller_mm, 0.011);
  EXPECT_NEAR(twin.pose().roller_mm, 12.0, 0.02);
}

}  // namespace
}  // namespace kerfbench::twin

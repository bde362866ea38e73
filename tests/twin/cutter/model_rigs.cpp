// SPDX-License-Identifier: Apache-2.0
#include "tests/twin/cutter/model_rigs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {

std::vector<StepEdge> trapezoid(double from_s, int count, double most_hz, double ramp_hz_s) {
  const double all = std::abs(count);
  const double peak_hz = std::min(most_hz, std::sqrt(all * ramp_hz_s));
  const double ramp_s = peak_hz / ramp_hz_s;
  const double in_ramp = 0.5 * peak_hz * ramp_s;
  const double total_s = 2.0 * ramp_s + (all - 2.0 * in_ramp) / peak_hz;
  std::vector<StepEdge> edges;
  for (int i = 0; i < std::abs(count); ++i) {
    const double place = i + 0.5;
    double at_s = ramp_s + (place - in_ramp) / peak_hz;
    if (place < in_ramp) at_s = std::sqrt(2.0 * place / ramp_hz_s);
    if (all - place < in_ramp) at_s = total_s - std::sqrt(2.0 * (all - place) / ramp_hz_s);
    edges.push_back({from_s + at_s, count > 0 ? 1 : -1});
  }
  return edges;
}

double endOf(const std::vector<StepEdge>& edges) { return edges.back().time_s; }

void feed(MachineModel& model, Axis axis, const std::vector<StepEdge>& edges) {
  std::vector<StepEdge>& incoming = model.command(axis).incoming();
  incoming.insert(incoming.end(), edges.begin(), edges.end());
}

void runModel(MachineModel& model, double until_s, const std::function<void(double time_s)>& each) {
  const long long steps = std::llround(until_s / MachineModel::kStep_s);
  for (long long i = 0; i < steps; ++i) {
    model.run(static_cast<std::uint64_t>(i), 1);
    if (each) each(static_cast<double>(i + 1) * MachineModel::kStep_s);
  }
}

StepperDescription nema23Stepper() {
  StepperDescription stepper;
  stepper.holding_torque_nm = 1.9;
  stepper.damping_nm_s = 6e-3;
  stepper.detent_torque_nm = 0.04;
  stepper.rated_current_a = 4.0;
  stepper.supply_v = 48.0;
  stepper.resistance_ohm = 0.6;
  stepper.inductance_h = 2e-3;
  return stepper;
}

MachineDescription gantryOnFeet() {
  MachineDescription machine = gantry();
  const double w = 2.0 * std::numbers::pi * 50.0;
  const double stiffness_n_m = 300.0 * w * w;
  const double damping_n_s_m = 2.0 * 0.05 * 300.0 * w;
  machine.frame = FrameDescription{300.0, {stiffness_n_m, stiffness_n_m}, {damping_n_s_m, damping_n_s_m}};
  return machine;
}

MachineDescription stepperGantry() {
  MachineDescription machine = gantryOnFeet();
  for (AxisDescription* axis : {&machine.gantry_x, &machine.gantry_y}) {
    axis->drive = nema23Stepper();
    axis->friction = {8.0, 20.0, 1e-6};
  }
  return machine;
}

MachineDescription limitedMirrors() {
  MachineDescription machine = twoMirror();
  for (AxisDescription* axis : {&machine.galvo_x, &machine.galvo_y}) {
    auto& servo = std::get<ServoDescription>(axis->drive);
    servo.max_torque = 0.03;
    servo.max_speed = 60.0;
    servo.current_lag_s = 20e-6;
    axis->friction = {2e-4, 1e-6, 1e-5};
  }
  return machine;
}

}  // namespace kerfbench::twin

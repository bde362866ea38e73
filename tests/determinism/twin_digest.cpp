// SPDX-License-Identifier: Apache-2.0
#include "tests/determinism/twin_digest.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <vector>

#include "tests/determinism/fnv.h"
#include "tests/twin/cutter/machines.h"
#include "twin/cutter/twin.h"

namespace kerfbench::determinism {
namespace {

using twin::MachineDescription;
using twin::Twin;

struct Axes {
  Signal x, y;
  double period_s;  ///< Period of the pulses.
};

bool onMirrors(Machine machine) {
  return machine == Machine::kMirrors || machine == Machine::kMirrorsWithSteppers;
}

Axes axesOf(Machine machine) {
  if (!onMirrors(machine)) return {Signal::kGantryXPul, Signal::kGantryYPul, 100e-6};
  // Pulses whose start is too sudden for the steppers.
  return {Signal::kGalvoXPul, Signal::kGalvoYPul, 40e-6};
}

/// A stepper too weak for its rotor, geared one to a hundred to the mirror.
twin::AxisDescription weakStepper(twin::AxisDescription axis) {
  constexpr double kGear = 0.01;
  twin::StepperDescription stepper;
  stepper.holding_torque_nm = 4e-4;
  stepper.damping_nm_s = 1e-6;
  stepper.detent_torque_nm = 2e-5;
  stepper.supply_v = 24.0;
  stepper.resistance_ohm = 2.0;
  stepper.inductance_h = 2e-3;
  axis.drive = stepper;
  axis.load_per_motor = kGear;
  axis.motor_inertia_kg_m2 = 1e-6;
  axis.stiffness = 100.0;
  axis.stiffness_damping = 2e-4;
  return axis;
}

MachineDescription machineOf(Machine machine) {
  if (!onMirrors(machine)) return twin::gantry();
  MachineDescription description = twin::twoMirror();
  if (machine == Machine::kMirrorsWithSteppers) {
    description.galvo_x = description.galvo_y = weakStepper(description.galvo_x);
  }
  return description;
}

/// A square of some millimetres, with the duty of the laser going up and down, while the belt runs.
std::vector<PinEvent> pinsOf(Machine machine, const SignalMap& map, double length_s) {
  constexpr int kSide = 160;
  twin::Pins pins(map);
  const Axes axes = axesOf(machine);
  double now_s = 1e-3;
  for (int side = 0; now_s < length_s; ++side) {
    const Signal pul = side % 2 == 0 ? axes.x : axes.y;
    now_s = pins.steps(pul, now_s, kSide, axes.period_s, side % 4 < 2) + 0.3e-3;
  }
  pins.set(1.5e-3, Signal::kLaserGate, true);
  pins.set(length_s - 1e-3, Signal::kLaserGate, false);
  constexpr double kPwm_s = 50e-6;
  for (int i = 0; i * kPwm_s < length_s; ++i) {
    pins.set(i * kPwm_s, Signal::kLaserPwm, true);
    pins.set(i * kPwm_s + (0.2 + 0.05 * (i % 13)) * kPwm_s, Signal::kLaserPwm, false);
  }
  if (machine == Machine::kGantryFed)
    pins.steps(Signal::kFeedPul, 2e-3, static_cast<int>(length_s / 250e-6), 250e-6, true);
  return pins.events();
}

void addSheet(const twin::Sheet& sheet, const twin::WebDescription& web, Fnv& hash) {
  // The square lies within 16 mm of where the resting beam meets the web, plus the belt's travel from there.
  constexpr int kBlock = 64;
  constexpr int kBlocks = static_cast<int>(16.0 / twin::Sheet::kCellMm) / kBlock + 1;
  const int middle = static_cast<int>(-web.start_x_mm / twin::Sheet::kCellMm) / kBlock;
  std::vector<float> nodes(static_cast<std::size_t>(kBlock) * kBlock);
  for (int row = -kBlocks; row < kBlocks; ++row) {
    for (int column = middle - kBlocks; column < middle + kBlocks; ++column) {
      if (sheet.copyNodes(column * kBlock, row * kBlock, kBlock, kBlock, nodes) <= 0.0F) continue;
      hash.add(static_cast<std::uint64_t>(column));
      hash.add(static_cast<std::uint64_t>(row));
      for (const float node : nodes) hash.add(node);
    }
  }
  hash.add(sheet.energyJ());
}

void addExposure(const twin::Exposure& exposure, Fnv& hash) {
  hash.add(exposure.sequence);
  hash.add(exposure.start_s);
  for (const twin::ExposureSample& sample : exposure.samples) {
    for (const double value : {sample.p_WQ_mm.x(), sample.p_WQ_mm.y(), sample.radius_mm, sample.power_w,
                               sample.p_WS_mm.x(), sample.p_WS_mm.y(), sample.angle_rad}) {
      hash.add(value);
    }
  }
}

void addPose(const Twin& twin, Fnv& hash) {
  const twin::MachinePose pose = twin.pose();
  const Twin::Truth truth = twin.truth();
  for (const double value :
       {pose.time_s, pose.roller_mm, pose.belt_travel_mm, pose.sheet_slip_mm.x(), pose.sheet_slip_mm.y(),
        pose.frame_mm.x(), pose.frame_mm.y(), pose.gantry_mm.x(), pose.gantry_mm.y(), pose.mirror_rad.x(),
        pose.mirror_rad.y(), truth.emitted_j, truth.p_WQ_mm.x(), truth.p_WQ_mm.y()}) {
    hash.add(value);
  }
}

}  // namespace

Digest digestOf(const TwinRun& run) {
  const twin::WebDescription web = run.machine == Machine::kGantryFed ? twin::fedWeb() : twin::lineWeb();
  const MachineDescription machine =
      twin::drawImperfections(machineOf(run.machine), twin::ImperfectionSpread{}, run.preset, run.seed)
          .machine;
  Twin twin(machine, web, twin::kRate, {.fidelity = run.fidelity, .seed = run.seed});
  Digest digest;
  Fnv exposures, sensors, lost, sheet, pose;
  constexpr Tick kQuantum = 8000;
  const auto each = [&](Tick, Tick, const std::vector<SensorEdge>& edges) {
    for (const SensorEdge& edge : edges) {
      sensors.add(edge.tick);
      sensors.add(static_cast<std::uint64_t>(edge.signal) * 2 + (edge.level ? 1 : 0));
    }
    digest.edge_count += edges.size();
    for (const twin::Exposure& exposure : twin.takeExposures()) {
      addExposure(exposure, exposures);
      ++digest.exposure_count;
    }
  };
  const auto events = pinsOf(run.machine, machine.signals, run.length_s);
  twin::run(twin, events, 0, twin::ticks(run.length_s), kQuantum, each);
  for (const twin::LostSteps& steps : twin.lostSteps()) {
    lost.add(steps.axis);
    lost.add(steps.time_s);
    lost.add(steps.place);
    lost.add(static_cast<std::uint64_t>(steps.full_steps));
  }
  digest.lost_count = twin.lostSteps().size();
  addPose(twin, pose);
  addSheet(twin.sheet(), web, sheet);
  digest.burnt_bytes = twin.sheet().bytes();
  digest.sheet = sheet.value();
  digest.exposures = exposures.value();
  digest.sensors = sensors.value();
  digest.lost_steps = lost.value();
  digest.pose = pose.value();
  return digest;
}

std::string nameOf(const TwinRun& run) {
  static constexpr std::array kNames{"mirrors", "mirrors with steppers", "gantry", "gantry, fed"};
  std::string name = kNames.at(static_cast<std::size_t>(run.machine));
  name += run.fidelity == twin::Fidelity::kFast ? ", fast" : ", reference";
  name += run.preset == twin::Preset::kIdeal    ? ", ideal"
          : run.preset == twin::Preset::kStatic ? ", static"
                                                : ", dynamic";
  return name + ", seed " + std::to_string(run.seed);
}

std::string textOf(const Digest& digest) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "sheet %016" PRIx64 " (%zu bytes) exposures %016" PRIx64 " (%zu) sensors %016" PRIx64
                " (%zu) lost %016" PRIx64 " (%zu) pose %016" PRIx64,
                digest.sheet, digest.burnt_bytes, digest.exposures, digest.exposure_count, digest.sensors,
                digest.edge_count, digest.lost_steps, digest.lost_count, digest.pose);
  return text.data();
}

std::vector<TwinRun> allRuns() {
  std::vector<TwinRun> runs;
  for (const Machine machine : kMachines) {
    for (const auto fidelity : {twin::Fidelity::kReference, twin::Fidelity::kFast}) {
      for (const auto preset : {twin::Preset::kIdeal, twin::Preset::kDynamic}) {
        runs.push_back({machine, fidelity, preset});
      }
    }
  }
  return runs;
}

}  // namespace kerfbench::determinism

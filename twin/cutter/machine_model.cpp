// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "twin/base/constants.h"
#include "twin/machine/fast_solver.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::twin {
namespace {

PulseCommand commandOf(const MachineMechanism& machine, Axis axis) {
  for (const MachineMechanism::PulseDrive& drive : machine.pulse_drives) {
    if (drive.axis == axis) return PulseCommand(drive.motor_per_step);
  }
  return PulseCommand(0.0);  // The axis is not fitted: its pulses have no effect.
}

std::optional<ScanHead> headOf(const MachineDescription& machine) {
  if (machine.kind == MachineDescription::Kind::kGantry) return std::nullopt;
  return ScanHead(machine.head, machine.beam);
}

}  // namespace

MachineModel::MachineModel(const MachineDescription& machine, const WebDescription& web, Fidelity fidelity)
    : machine_(mechanismOf(machine, web)),
      gantry_(machine.kind == MachineDescription::Kind::kGantry),
      roller_radius_mm_(machine.belt.roller_radius_mm),
      squareness_sin_(std::sin(machine.squareness_rad)),
      squareness_cos_(std::cos(machine.squareness_rad)),
      line_(web.belt_speed_mm_s, web.belt_speed_changes),
      beam_(machine.beam),
      surface_(machine.surface),
      head_(headOf(machine)),
      commands_{commandOf(machine_, Axis::kGalvoX), commandOf(machine_, Axis::kGalvoY),
                commandOf(machine_, Axis::kGantryX), commandOf(machine_, Axis::kGantryY),
                commandOf(machine_, Axis::kFeed)},
      fidelity_(fidelity) {
  const auto mechanism = std::make_shared<const Mechanism>(machine_.description);
  for (const StepperLaw& law : mechanism->law().steppers) {
    watches_.push_back({law.input, law.joint, law.pitch(), law.offset, 0});
  }
  if (fidelity == Fidelity::kFast) {
    solver_ = std::make_unique<FastSolver>(mechanism, kStep_s);
  } else {
    solver_ = std::make_unique<ReferenceSolver>(mechanism, kStep_s);
  }
  if (machine_.line_drive) line_rad_ = lineCommand_rad(0.0);
  note();
}

double MachineModel::lineCommand_rad(double time_s) const {
  return line_.travel_mm(time_s - machine_.line_delay_s) / roller_radius_mm_;
}

void MachineModel::run(std::uint64_t first, std::uint64_t steps) {
  // Teeth are counted after each step, and the last step is made alone, for its accelerations.
  constexpr std::uint64_t kMostAtOnce = 64;
  const std::uint64_t most = watches_.empty() ? kMostAtOnce : 1;
  const std::uint64_t end = first + steps;
  while (first < end) {
    const auto now = static_cast<std::size_t>(first + 1 == end ? 1 : std::min(most, end - 1 - first));
    if (first + 1 == end) note();
    makeInputs(first, now);
    solver_->run(static_cast<double>(first) * kStep_s, now, inputs_);
    first += now;
    time_s_ = static_cast<double>(first - 1) * kStep_s + kStep_s;
    watchTeeth();
  }
}

void MachineModel::makeInputs(std::uint64_t first, std::size_t steps) {
  const std::size_t drives = machine_.description.drives.size();
  inputs_.resize(std::max(inputs_.size(), steps * drives));
  for (std::size_t i = 0; i < machine_.pulse_drives.size(); ++i) {
    const MachineMechanism::PulseDrive& drive = machine_.pulse_drives[i];
    PulseCommand& pulses = command(drive.axis);
    for (std::size_t k = 0; k < steps; ++k) {
      const double input_time_s = static_cast<double>(first + k) * kStep_s - drive.input_delay_s;
      const double mean = pulses.meanOver(input_time_s, input_time_s + kStep_s);
      inputs_[k * drives + i] = {mean, mean, mean};
    }
  }
  if (!machine_.line_drive) return;
  for (std::size_t k = 0; k < steps; ++k) {
    const double begin_s = static_cast<double>(first + k) * kStep_s;
    const double end_rad = lineCommand_rad(begin_s + kStep_s);
    // Only the reference takes the line's command for bent within a step.
    const bool bent = fidelity_ == Fidelity::kReference;
    const double middle_rad = bent ? lineCommand_rad(begin_s + 0.5 * kStep_s) : 0.5 * (line_rad_ + end_rad);
    inputs_[(k + 1) * drives - 1] = {line_rad_, middle_rad, end_rad};
    line_rad_ = end_rad;
  }
}

void MachineModel::note() {
  before_.roller_mm_s = rollerSpeed_mm_s();
  before_.sheet_mm_s = sheetSpeed_mm_s();
  if (gantry_) before_.gantry_mm = pose().gantry_mm;
}

double MachineModel::rollerSpeed_mm_s() const { return solver_->v()[machine_.roller] * roller_radius_mm_; }

double MachineModel::rollerAcceleration_mm_s2() const {
  return (rollerSpeed_mm_s() - before_.roller_mm_s) / kStep_s;
}

double MachineModel::sheetSpeed_mm_s() const {
  const auto v = solver_->v();
  return (v[machine_.belt] + v[machine_.sheet_x]) * kMetre_mm;
}

double MachineModel::sheetAcceleration_mm_s2() const {
  return (sheetSpeed_mm_s() - before_.sheet_mm_s) / kStep_s;
}

Eigen::Vector2d MachineModel::gantrySpeed_mm_s() const {
  return (pose().gantry_mm - before_.gantry_mm) / kStep_s;
}

void MachineModel::watchTeeth() {
  for (ToothWatch& watch : watches_) {
    const double lag_rad = inputs_[watch.drive].end + watch.offset_rad - solver_->q()[watch.joint];
    const double teeth = lag_rad / watch.pitch_rad;
    if (std::abs(teeth - static_cast<double>(watch.behind)) <= 0.5) continue;
    constexpr long long kFullStepsOfATooth = 4;
    const long long now = std::llround(teeth);
    const MachineMechanism::PulseDrive& drive = machine_.pulse_drives[watch.drive];
    lost_.push_back({nameOf(drive.axis), time_s_, command(drive.axis).position() * drive.load_per_motor,
                     (now - watch.behind) * kFullStepsOfATooth});
    watch.behind = now;
  }
}

MachinePose MachineModel::pose() const {
  const auto q = solver_->q();
  MachinePose pose;
  pose.time_s = time_s_;
  pose.roller_mm = q[machine_.roller] * roller_radius_mm_;
  pose.belt_travel_mm = q[machine_.belt] * kMetre_mm;
  pose.sheet_slip_mm = {q[machine_.sheet_x] * kMetre_mm, q[machine_.sheet_y] * kMetre_mm};
  if (machine_.frame_x) {
    pose.frame_mm = {q[*machine_.frame_x] * kMetre_mm, q[*machine_.frame_y] * kMetre_mm};
  }
  const Eigen::Vector2d head(q[*machine_.head_x], q[*machine_.head_y]);
  if (gantry_) {
    pose.gantry_mm = kMetre_mm * head;
  } else {
    pose.mirror_rad = head;
  }
  return pose;
}

std::optional<BeamSpot> MachineModel::spot() const {
  const MachinePose at = pose();
  if (head_) return head_->spotAt(at.mirror_rad, at.frame_mm, surface_, time_s_);
  const double y_mm = at.gantry_mm.y();
  const Eigen::Vector2d on_frame_mm(at.gantry_mm.x() - squareness_sin_ * y_mm, squareness_cos_ * y_mm);
  return gantrySpot(at.frame_mm + on_frame_mm, beam_, surface_, time_s_);
}

}  // namespace kerfbench::twin

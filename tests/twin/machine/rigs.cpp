// SPDX-License-Identifier: Apache-2.0
#include "tests/twin/machine/rigs.h"

#include <cmath>
#include <numbers>

#include "twin/machine/fast_solver.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::twin {

std::ostream& operator<<(std::ostream& out, Solve solve) {
  return out << (solve == Solve::kFast        ? "fast"
                 : solve == Solve::kReference ? "reference"
                                              : "reference, every stage");
}

std::unique_ptr<Solver> solverOf(const MechanismDescription& description, Solve solve, double step_s) {
  const auto mechanism = std::make_shared<const Mechanism>(description);
  if (solve == Solve::kFast) return std::make_unique<FastSolver>(mechanism, step_s);
  using Accelerations = ReferenceSolver::Accelerations;
  return std::make_unique<ReferenceSolver>(
      mechanism, step_s, solve == Solve::kReference ? Accelerations::kOnceAStep : Accelerations::kEveryStage);
}

JointDescription rotorOf(const std::string& name, double inertia_kg_m2) {
  JointDescription joint;
  joint.name = name;
  joint.kind = JointDescription::Kind::kRevolute;
  joint.mass_kg = 0.0;
  joint.inertia_kg_m2 = inertia_kg_m2;
  return joint;
}

JointDescription slideOf(const std::string& name, double mass_kg, int parent, const Eigen::Vector3d& axis) {
  JointDescription joint;
  joint.name = name;
  joint.kind = JointDescription::Kind::kPrismatic;
  joint.parent = parent;
  joint.axis = axis;
  joint.mass_kg = mass_kg;
  joint.inertia_kg_m2 = 0.1;
  return joint;
}

MechanismDescription driven(const DriveDescription& drive, double inertia_kg_m2) {
  MechanismDescription description;
  description.joints = {rotorOf("rotor", inertia_kg_m2)};
  JointDrive of_rotor;
  of_rotor.name = "drive";
  of_rotor.drive = drive;
  of_rotor.inertia_kg_m2 = inertia_kg_m2;
  description.drives = {of_rotor};
  return description;
}

ServoDescription servoOf(double bandwidth_hz, double damping, double feedforward) {
  ServoDescription servo;
  servo.natural_frequency_rad_s = 2.0 * std::numbers::pi * bandwidth_hz;
  servo.damping = damping;
  servo.velocity_feedforward = feedforward;
  return servo;
}

MechanismDescription sheetOnBelt() {
  MechanismDescription description;
  description.joints = {slideOf("belt", kBelt_kg), slideOf("sheet.x", 0.0, 0),
                        slideOf("sheet.y", kSheet_kg, 1, Eigen::Vector3d::UnitY())};
  JointFriction grip;
  grip.joint = 1;
  grip.across = 2;
  grip.friction.coulomb = kGrip_n;
  description.frictions = {grip};
  return description;
}

void run(Solver& solver, std::size_t drives, double from_s, double until_s, const CommandFn& command,
         const StepFn& each, double step_s) {
  std::vector<DriveCommand> commands(drives);
  const long long first = std::llround(from_s / step_s);
  const long long last = std::llround(until_s / step_s);
  for (long long i = first; i < last; ++i) {
    const double begin_s = static_cast<double>(i) * step_s;
    if (command) commands[0] = {command(begin_s), command(begin_s + 0.5 * step_s), command(begin_s + step_s)};
    solver.step(begin_s, commands);
    if (each) each(begin_s + step_s);
  }
}

void run(Solver& solver, double until_s, const StepFn& each) { run(solver, 0, 0.0, until_s, {}, each); }

}  // namespace kerfbench::twin

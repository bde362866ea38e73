// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "twin/machine/solver.h"

namespace kerfbench::twin {

inline constexpr double kStep_s = 10e-6;

/// Solvers under test.
enum class Solve { kReference, kEveryStage, kFast };
inline constexpr Solve kSolvers[] = {Solve::kReference, Solve::kEveryStage, Solve::kFast};
std::ostream& operator<<(std::ostream& out, Solve solve);

std::unique_ptr<Solver> solverOf(const MechanismDescription& description, Solve solve,
                                 double step_s = kStep_s);

JointDescription rotorOf(const std::string& name, double inertia_kg_m2);
JointDescription slideOf(const std::string& name, double mass_kg, int parent = -1,
                         const Eigen::Vector3d& axis = Eigen::Vector3d::UnitX());

/// One rotor behind a drive.
MechanismDescription driven(const DriveDescription& drive, double inertia_kg_m2);
/// A servo with this bandwidth and nothing else.
ServoDescription servoOf(double bandwidth_hz, double damping, double feedforward = 0.0);

/// A belt of 2 kg that slides freely along x, and a sheet of 50 g on it with a dry friction of 0.3 N in both
/// directions together. Joints: belt, sheet x, sheet y.
MechanismDescription sheetOnBelt();
inline constexpr double kBelt_kg = 2.0;
inline constexpr double kSheet_kg = 0.05;
inline constexpr double kGrip_n = 0.3;

/// Command of the first drive at a time; the others' are 0.
using CommandFn = std::function<double(double time_s)>;
/// Called after each step.
using StepFn = std::function<void(double time_s)>;
void run(Solver& solver, std::size_t drives, double from_s, double until_s, const CommandFn& command,
         const StepFn& each = {}, double step_s = kStep_s);
/// Runs a mechanism without drives.
void run(Solver& solver, double until_s, const StepFn& each = {});

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "twin/cutter/machine_model.h"

namespace kerfbench::twin {

/// Edges of `count` steps (negative: backwards) from `from_s`, with a trapezoid of speed.
std::vector<StepEdge> trapezoid(double from_s, int count, double most_hz, double ramp_hz_s);
/// Time of the last edge.
double endOf(const std::vector<StepEdge>& edges);
void feed(MachineModel& model, Axis axis, const std::vector<StepEdge>& edges);

/// Steps a model from t = 0.
void runModel(MachineModel& model, double until_s, const std::function<void(double time_s)>& each = {});

StepperDescription nema23Stepper();
/// Gantry of machines.h with a frame of 300 kg on feet of 50 Hz.
MachineDescription gantryOnFeet();
/// Gantry with steppers in place of its servos, and friction that they have to overcome.
MachineDescription stepperGantry();
/// Two mirrors with limits of torque and speed, current lag and friction.
MachineDescription limitedMirrors();

}  // namespace kerfbench::twin

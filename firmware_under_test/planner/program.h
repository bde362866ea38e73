// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware_under_test/planner/plan.h"
#include "firmware_under_test/planner/solve.h"

namespace kerfbench::planner {

/// All units as operations of the controller.
/// @throws PlanError if an axis would have to make more steps in a period than the controller can.
Program makeProgram(const Solution& solution, const MachineParameters& machine, const JobParameters& job,
                    const PlannerFaults& faults, const Axes& axes);

/// PWM byte for marks of Z times `marked_mm` in one period (S3: energy per length stays, so power follows
/// speed). May exceed 255: the laser is then too weak.
double powerByte(double marked_mm, const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

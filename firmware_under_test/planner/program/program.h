// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/power/model.h"
#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {

/// Writes all units as operations of the controller. The controller stops the job on a belt that it follows
/// and that is faster than `belt_stop_mm_s`. @throws PlanError if an axis would have to make more steps in a
/// period than the controller can.
Program makeProgram(const Solution& solution, const MachineParameters& machine, const JobParameters& job,
                    const PlannerFaults& faults, const Axes& axes, double belt_stop_mm_s);

/// Program as text: one line for the configuration ("config" and its bytes), then one for each operation, in
/// hexadecimal.
std::string programText(const Program& program);

/// PWM byte for the marks of one period, marked_mm > 0 (S3: power follows speed). Without a power model the
/// energy per length stays, and the byte may exceed 255: the laser is then too weak. With one it is a whole
/// number within the laser's limits.
double powerByte(const Sample& sample, const MachineParameters& machine, const JobParameters& job);
/// Setting of the power model for the marks of one period, marked_mm > 0. @pre job.power
PowerModel::Setting powerSetting(const Sample& sample, const MachineParameters& machine,
                                 const JobParameters& job);

}  // namespace kerfbench::planner

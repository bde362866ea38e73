// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Page that plays the first unit of the job: the steps, power and gate of the program that would be sent to
/// the controller, period by period, as places on the sheet to 1e-9 mm. Everything in one file, nothing
/// loaded from elsewhere. A job that does not fit has no program and is shown as planned, at the belt's speed
/// or, where the axes are too slow for that, on a resting sheet; the page then says what is wrong. Same
/// input, same bytes. @throws PlanError if the G-code cannot be read or the parameters are unusable.
std::string previewHtml(const std::string& title, const std::string& gcode, const MachineParameters& machine,
                        const JobParameters& job, const PlannerFaults& faults = {});

}  // namespace kerfbench::planner

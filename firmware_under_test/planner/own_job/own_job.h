// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/own_job/job_table.h"
#include "firmware_under_test/planner/own_job/mcs51_controller.h"

namespace kerfbench::planner {

/// A job as a control program of its own (Cheng, Cui, Zhang 2014, section 3.4).
struct OwnJob {
  std::string source;   ///< C for SDCC.
  std::string summary;  ///< Memory and time that it takes, for people.
  JobTable table;
  Plan plan;
  Mcs51Account account;
};

/// Plans the G-code of a unit for a controller that holds the whole job, is started by a pin, and follows the
/// belt by its own clock. Memory and the time of a tick are checked before anything is written.
/// @param title First line of the program. @throws PlanError with what does not fit, and what would.
OwnJob makeOwnJob(const std::string& title, const std::string& gcode, MachineParameters machine,
                  JobParameters job, const Mcs51Controller& controller);

}  // namespace kerfbench::planner

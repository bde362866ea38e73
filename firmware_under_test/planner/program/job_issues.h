// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Faults of the two parameter sets, one sentence each; empty if they are usable.
std::vector<std::string> jobIssues(const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

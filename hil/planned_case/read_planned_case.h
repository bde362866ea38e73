// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "firmware_under_test/planner/kerfplan/planned_case.h"

namespace kerfbench::planned_case {

/// Reads scenario and machine with the bench's readers, as `kerfbench plan` does. `job` has what a machine
/// alone does not say. Releases are looked for beside `bin_dir`, the folder of the programs.
/// @throws planner::PlanError, planner::PowerError or dieline::DielineError with everything that is wrong.
planner::PlannedCase readPlannedCase(const planner::CaseFiles& files, const planner::JobParameters& job,
                                     const std::filesystem::path& bin_dir);

}  // namespace kerfbench::planned_case

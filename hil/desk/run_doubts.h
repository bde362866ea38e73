// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/program/unit_motion.h"
#include "hil/scenario/case.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// What makes a run of a job that fits end as INVALID or slow, as can be told before it, with what to change:
/// a release whose steps are too few for the speeds that are asked, and a spot that the twin's camera hardly
/// sees. A sentence each.
std::vector<std::string> runDoubts(const scenario::Case& test_case, const planner::MachineParameters& machine,
                                   const planner::JobParameters& job, const planner::UnitMotion& motion,
                                   const planner::Axes& axes);

}  // namespace kerfbench::desk

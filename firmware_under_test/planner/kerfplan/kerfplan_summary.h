// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {

/// What a job that fits takes, as text for people: belt, time, ways, jumps, program, field and pitch.
std::string summaryOf(const std::string& input, const CheckResult& checked, const Plan& plan,
                      const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

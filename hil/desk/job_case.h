// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "hil/desk/desk_issue.h"
#include "hil/desk/desk_request.h"
#include "hil/scenario/case.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// The case of a text that a planner serves, or why there is none.
struct JobCase {
  std::optional<scenario::Case> test_case;
  std::vector<DeskIssue> issues;
};

/// `has_gcode`: the file of planner.gcode need not be there, its text comes from elsewhere.
JobCase jobCaseOf(const ScenarioText& scenario, bool has_gcode, const DeskRequest& request);

}  // namespace kerfbench::desk

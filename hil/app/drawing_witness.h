// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/base/console.h"
#include "hil/base/stopwatch.h"
#include "hil/judge/run_options.h"
#include "hil/scenario/case.h"

namespace kerfbench::app {

/// Has the drawing of a scenario that demands a witness read a second time, before anything runs. Where the
/// readers agree, or none is demanded, the case says so and nothing is returned. Else the exit code is: of
/// the verdict INVALID, with a report in the results folder `folder_name`, where they part;
/// base::kExitBroken, with a sentence on standard error and no results, where there was no second reading.
std::optional<int> refusedByWitness(scenario::Case& test_case, const std::string& folder_name,
                                    const judge::RunOptions& options, base::Stopwatch& stopwatch,
                                    base::Console& console);

}  // namespace kerfbench::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/kerfplan/kerfplan_options.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// True for a file that is G-code by its name, and for standard input.
bool namesGcode(const std::string& input);

/// Name of what is planned: the title of the scenario, or the file's name.
std::string nameOf(const KerfplanOptions& options);

/// The drawing that is planned, as selected. @throws DielineError, PlanError.
dieline::Dieline chosenOf(const KerfplanOptions& options);

/// G-code of one unit, given or made of the drawing; notes go to standard error. @throws DielineError,
/// PlanError.
std::string gcodeOf(const KerfplanOptions& options);

/// Sentences of the planner with the file's name before each that is about the G-code that was given.
std::string withFile(const KerfplanOptions& options, const std::string& sentences);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware_under_test/planner/kerfplan/planned_case.h"

namespace kerfbench::planner {

/// The host half of the reference controller as a program; returns its exit code. `read_case` reads the files
/// of --scenario and --machine; a program without one hands such a command line over to kCaseProgram.
int kerfplanMain(int argc, char** argv, const CaseReader& read_case);

/// Program that does what kerfplan does and has the bench's readers; it lies beside it.
inline constexpr const char* kCaseProgram = "kerfplan-scenario";

}  // namespace kerfbench::planner

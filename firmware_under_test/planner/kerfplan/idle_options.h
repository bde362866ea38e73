// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_power.h"

namespace kerfbench::planner {

/// What decides which options have an effect.
struct OptionContext {
  const MachineParameters& machine;
  const JobParameters& job;
  const PowerOptions& power;
  bool is_gcode{};     ///< The input is G-code: the order, the perforations and the Z of its lines are given.
  bool by_scenario{};  ///< A scenario says how the drawing is read.
};

/// Refuses options that were given to a command and have no effect beside the others: a job that is planned
/// without something that its user asked for is another job. @throws CLI::ValidationError that names all of
/// them, and what they need.
void refuseIdleOptions(const CLI::App& command, const OptionContext& context);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/own_job/own_job.h"

namespace kerfbench::planner {

/// Options of `kerfplan program` for a controller that holds its job.
struct OwnJobOptions {
  enum class Target { kUart, kMcs51 };
  Target target{Target::kUart};
  Mcs51Controller controller;
  double tick_us{};  ///< 0: the shortest.
};

void addOwnJobOptions(CLI::App& app, OwnJobOptions& options);

/// Source of the control program; its account goes to standard error.
std::string ownJobSource(const OwnJobOptions& options, const std::string& input, const std::string& gcode,
                         const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

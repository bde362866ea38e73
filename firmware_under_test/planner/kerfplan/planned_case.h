// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Files whose values the options have as their defaults.
struct CaseFiles {
  std::string scenario;  ///< Empty: none.
  std::string machine;   ///< In place of the scenario's; empty: that.
  std::string image;     ///< Release in place of the scenario's; empty: that.
  std::string drawing;   ///< Drawing in place of the scenario's; empty: that.
  bool has_gcode{};      ///< G-code comes from elsewhere: what the scenario would have cut is not read.
};

/// What such files say, in the planner's own terms.
struct PlannedCase {
  MachineParameters machine;
  JobParameters job;
  PlannerFaults faults{};
  std::string title;  ///< For pages; empty with a machine alone.
  /// Drawing as the scenario has it read and selected; null with a machine alone, and with G-code.
  std::shared_ptr<const dieline::Dieline> dieline{};
  std::optional<std::string> gcode{};  ///< One unit, edited by hand.
};

/// Reads files into a case; `job` has what a machine alone does not say. The planner knows nothing of the
/// bench's files: a program that has their readers hands this in.
/// @throws PlanError, PowerError or DielineError with everything that is wrong.
using CaseReader = std::function<PlannedCase(const CaseFiles& files, const JobParameters& job)>;

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/target.h"
#include "hil/base/console.h"
#include "hil/run/dialog.h"
#include "hil/scenario/case.h"
#include "twin/base/signal_map.h"

namespace kerfbench::run {

/// Pulses of one axis in a program.
struct AxisPulses {
  Signal pul{};
  long long count{};
};

/// A job ready to be sent, and what is worth telling of it.
struct PreparedJob {
  std::unique_ptr<Dialog> dialog;
  std::string summary;  ///< One line.
  std::string gcode;    ///< For the results folder.
  double expected_s{};  ///< About how long the machine takes by the plan, for people; 0: nobody knows.
  /// What the image says of itself; empty if it is not the reference controller's.
  std::string controller{};
  planner::Target target;   ///< Controller for which the job was planned.
  double belt_stop_mm_s{};  ///< As the planner has told the controller.
  /// Where the host starves: all pulses in what it has of each axis that moves and never follows the belt.
  /// One that does makes more.
  std::vector<AxisPulses> starved{};
};

/// Plans the job (reference controller) or reads the G-code (line-and-ok firmware). No dialog for a job that
/// is started at the machine.
/// @throws planner::PlanError, std::system_error.
PreparedJob prepareJob(const scenario::Case& test_case);

/// Period of the controller's program; it is known of the reference controller alone.
std::optional<double> programPeriod_s(const PreparedJob& job);

/// Tells what the controller said in the job's dialog, if it has one, that is no fault and should be known.
void tellRemarks(const PreparedJob& job, base::Console& console);

}  // namespace kerfbench::run

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/motion/solve.h"

namespace kerfbench::planner {

/// Result of a check: all that is wrong with a job, and its demands on the machine if nothing is.
struct CheckResult {
  std::vector<std::string> errors;    ///< One sentence each, with the line of the G-code where there is one.
  std::vector<std::string> warnings;  ///< Doubts: the job can be cut, but hardly as it was meant.
  std::optional<Solution> solution;   ///< Solution at the job's belt speed.
  /// Highest belt speed as in Plan; 0 while the G-code or the parameters are unusable.
  double max_belt_speed_mm_s{};
};

/// Checks parameters, G-code, field, power, belt and pitch, all at once. Checks that need the motion are made
/// only if text and parameters are sound.
CheckResult checkJob(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                     const PlannerFaults& faults = {});

/// Marks that lie outside the field across the belt, which no belt speed can mend.
std::vector<std::string> outsideAcross(const std::vector<Segment>& path, const MachineParameters& machine);

/// Marks for which the laser is too weak at the speed they reach.
std::vector<std::string> powerFaults(const UnitPath& unit, const MachineParameters& machine,
                                     const JobParameters& job);

/// Describes where a job with a power model marks so slowly that the laser's least power is too much: a
/// sentence for each Z.
std::vector<std::string> powerWarnings(const UnitPath& unit, const JobParameters& job);

}  // namespace kerfbench::planner

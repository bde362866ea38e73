// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/program/cross_cut.h"

namespace kerfbench::planner {

/// What a strip cut to length takes, by S0's formulas and by the planned motion with its ramps.
struct Throughput {
  double formula_highest_mm_s{};  ///< Highest feed by both constraints.
  double planned_highest_mm_s{};  ///< Highest feed at which the planner finds a motion; never more.
  /// Time until so many pieces are cut.
  struct Times {
    double pieces{};
    double stops_s{}, planned_stops_s{};  ///< Feeding and stopping: n (L / v_x + y0 / v_y), and with ramps.
    double runs_s{}, planned_runs_s{};    ///< On the run: n L / v_x + y0 / v_y, and with ramps.
  };
  std::vector<Times> times;
};

/// Both methods for 1, 10, 100, 1000 and 10 000 pieces. @throws PlanError that lists every constraint that
/// does not hold, and the highest feed that can be planned.
Throughput throughputOf(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job);

/// The same as a table for people.
std::string throughputTable(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// What goes down the UART.
struct Program {
  std::vector<std::uint8_t> config;            ///< KB_CONFIG payload.
  std::vector<std::vector<std::uint8_t>> ops;  ///< Whole operations, in order.
  std::vector<std::uint8_t> power{};           ///< KB_POWER payload; empty: no loop on the power.
  Target target{};                             ///< The controller.
};

struct Plan {
  std::string gcode;             ///< One unit in S4's dialect.
  Program program;               ///< All units.
  double unit_time_s{};          ///< From the start of a unit (its print mark come up) to its last mark.
  double cycle_time_s{};         ///< unit_time_s and the way back to where the next unit starts.
  double max_belt_speed_mm_s{};  ///< The highest at which this job, cut in this order, fits field and pitch.
  double belt_stop_mm_s{};       ///< The controller stops the job on a faster belt; 0: on none.
  double cut_length_mm{};        ///< Length of one unit, all marks.
  double jump_length_mm{};       ///< Length of one unit, between its marks.
  double x_ref_mm{};             ///< x_W of unit 0's origin at its start.
};

/// Dieline to G-code in the job's order: whole outlines, creases before cuts, holes before outlines. Where
/// the belt is too fast for that, outlines are broken at their corners, and at last creases go first only
/// where they lie side by side with cuts. G00/G01/G02/G03, I J from the arc's start, LINE / ARC / CIRCLE
/// headings, Z as laser.
std::string makeGcode(const dieline::Dieline& dieline, const MachineParameters& machine,
                      const JobParameters& job, const PlannerFaults& faults = {});
/// G-code of one unit to the program of all of them. @throws PlanError with line numbers.
Plan planFromGcode(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                   const PlannerFaults& faults = {});
/// Both. @throws PlanError.
Plan plan(const dieline::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
          const PlannerFaults& faults = {});

}  // namespace kerfbench::planner

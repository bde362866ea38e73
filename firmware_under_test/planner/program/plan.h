// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/process.h"

namespace kerfbench::planner {

struct CheckResult;  // Defined in planner/program/check.h.

/// Operations of a program by their number: from `begin` up to `end`, which is not one of them.
struct OpRange {
  std::size_t begin{};
  std::size_t end{};
};

/// Program for the UART.
struct Program {
  std::vector<std::uint8_t> config;            ///< KB_CONFIG payload.
  std::vector<std::vector<std::uint8_t>> ops;  ///< Whole operations, in order.
  std::vector<std::uint8_t> power{};           ///< KB_POWER payload; empty: no loop on the power.
  Target target{};                             ///< The controller.
  /// Operations of each unit, from the first period in which the beam catches up with the sheet to the last
  /// of its marks; without the moves between units. Not sent.
  std::vector<OpRange> units{};
};

struct Plan {
  std::string gcode;      ///< One unit in S4's dialect.
  Program program;        ///< All units.
  double unit_time_s{};   ///< Time from the start of a unit (its print mark has come) to its last mark.
  double cycle_time_s{};  ///< Time of a unit and of the return to where the next unit starts.
  /// Highest belt speed at which this job, cut in this order, fits field and pitch.
  double max_belt_speed_mm_s{};
  double belt_stop_mm_s{};  ///< Belt speed above which the controller stops the job; 0: none.
  double cut_length_mm{};   ///< Length of all marks of one unit.
  double jump_length_mm{};  ///< Length of all jumps between the marks of one unit.
  double x_ref_mm{};        ///< Place x_W of unit 0's origin at its start.
};

/// Writes a dieline as G-code in the job's order: whole outlines, creases before cuts, holes before outlines.
/// Where the belt is too fast for that, outlines are broken at their corners, and at last creases go first
/// only where they lie side by side with cuts. G00/G01/G02/G03, I J from the arc's start, LINE / ARC / CIRCLE
/// headings, Z as laser.
std::string makeGcode(const dieline::Dieline& dieline, const MachineParameters& machine,
                      const JobParameters& job, const PlannerFaults& faults = {});
/// Plans the program of all units from the G-code of one. @throws PlanError with line numbers.
Plan planFromGcode(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                   const PlannerFaults& faults = {});
/// The same of a job that was checked: `checked` is of this G-code, machine and job.
Plan planFromChecked(const CheckResult& checked, const std::string& gcode, const MachineParameters& machine,
                     const JobParameters& job, const PlannerFaults& faults = {});
/// Plans a dieline: G-code and program. @throws PlanError.
Plan plan(const dieline::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
          const PlannerFaults& faults = {});

}  // namespace kerfbench::planner

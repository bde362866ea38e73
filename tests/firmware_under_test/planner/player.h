// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/program/cross_cut.h"
#include "firmware_under_test/planner/program/plan.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner::test {

/// One period as an ideal machine runs it: drives that lag by exactly the tracking delay, a belt at constant
/// speed.
struct Period {
  Eigen::Vector2d from_W_mm, to_W_mm;  ///< Beam at the begin and end, from steps by S4's eq. 1.
  Eigen::Vector2d from_S_mm, to_S_mm;  ///< Places on the sheet at the begin and end, in S of unit 0's web.
  int power{-1};                       ///< Power; -1: gate closed.
  int largest_steps{};
  int unit{-1};
  bool following{};
  double gain{};
};

/// Record of a program's run.
struct Played {
  std::vector<Period> periods;
  int feed_steps{};
  int marks_waited{};
  bool ended{};
  std::string error;  ///< First byte that the protocol does not know.
};

/// Runs the program. The belt's position comes from the print marks and its speed, or from the feed steps.
Played play(const Program& program, const MachineParameters& machine, const JobParameters& job);

/// Text of the PlanError that the action throws; empty if it throws none.
template <typename Do>
std::string refusal(const Do& action) {
  try {
    action();
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

MachineParameters twoMirror();
MachineParameters gantry();
JobParameters mirrorJob();
JobParameters gantryJob();

dieline::Entity line(double x0, double y0, double x1, double y1,
                     dieline::Process process = dieline::Process::kCut);
dieline::Entity arc(double cx, double cy, double r, double start_deg, double sweep_deg);
/// Dieline with numbered entities.
dieline::Dieline dielineOf(std::vector<dieline::Entity> entities);
/// Rounded rectangle, x in [-60, 0], y in [-20, 20], radius 3.
dieline::Dieline label();
/// A folding box in small: outline with flaps, creases, a slot, a round window, a perforation; x in [-142,
/// 0].
dieline::Dieline carton();
/// Cut of S0 across the strip.
dieline::Dieline strip();
/// Figures of S0's example: pieces of 1200 mm, 800 mm wide, 200 and 230 mm/s; a way back at 400 mm/s.
CrossCut paperCut();

/// Worst distance of burnt points from the dieline, over all units.
double worstDeviationMm(const Played& played, const dieline::Dieline& dieline, const JobParameters& job);
/// Worst distance of points of entities (but perforations) from the burnt path of a unit.
double worstGapMm(const Played& played, const dieline::Dieline& dieline, const JobParameters& job, int unit);

}  // namespace kerfbench::planner::test

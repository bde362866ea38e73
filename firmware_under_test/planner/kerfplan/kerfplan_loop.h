// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/power/loop.h"

namespace kerfbench::planner {

/// A tube and the meter behind it, for comparing laws of the loop on the measured power.
struct LoopCase {
  double tube{0.95};    ///< Power over the nominal one; in 0.5 … 1.5.
  int late_periods{4};  ///< Periods until a measurement can be used; 0: as in the paper; at most 100.
  PowerLimits limits;
  double period_s{};
};

/// Courses of the paper's law and of the damped one over the wanted powers of a job's marks, period by
/// period: the largest and the root mean square departure of each from what is wanted, after the first 40
/// periods, and without a loop. @throws PowerError unless the case and the powers can be run.
std::string loopTable(const std::vector<double>& wanted_w, const LoopCase& loop);
/// Plot (SVG): power over time, wanted, and as the paper's law and the firmware's make it.
std::string loopPlot(const std::vector<double>& wanted_w, const LoopCase& loop);

}  // namespace kerfbench::planner

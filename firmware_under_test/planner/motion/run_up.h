// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "firmware_under_test/planner/motion/runs.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// Way that a beam takes along the path from rest to the speed of marks, and from there to rest, with a
/// period to spare since runs take whole periods.
double runUpMm(const FlowLimits& limits);

/// Lets marks begin and end at speed: in front of each mark that a straight jump leads to, and of the first,
/// the beam comes from `length_mm` before it along its tangent with the laser off; behind the last mark
/// before a jump, and the last of all, it goes on as far. `runs` are
/// straightRuns().
void addRunUps(std::vector<Run>& runs, double length_mm);

}  // namespace kerfbench::planner

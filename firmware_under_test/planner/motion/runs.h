// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/jumps_taken.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// A part of a unit with the laser in one state, which does not turn back on itself.
struct Run {
  std::vector<Segment> segments;  ///< Segments of the run; one or more.
  bool rests{};                   ///< True if the beam is at rest on the sheet where the run begins.
  /// True if the unit may be held back before the run to wait for the sheet. Implies `rests`.
  bool begins_block{};
};

/// Divides a path with straight jumps: every run begins and ends at rest, every jump begins a block. `path`
/// begins and ends with marks.
std::vector<Run> straightRuns(const std::vector<Segment>& path);

/// Divides a path with jumps as curves (jump_curve.h). Of radii from the wished one down to an eighth of it,
/// the one with the least estimated time is taken: a short jump that would have to turn right round takes
/// less time with small arcs. A jump is straight, with a stop at both ends, where no curve serves, and where
/// the wish says so; `taken` says which. A straight jump begins a block.
std::vector<Run> smoothRuns(const std::vector<Segment>& path, const JumpWish& wish, const FlowLimits& limits,
                            JumpsTaken& taken);

}  // namespace kerfbench::planner

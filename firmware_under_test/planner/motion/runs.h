// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// A part of a unit with the laser in one state and without a corner.
struct Run {
  std::vector<Segment> segments;  ///< Segments of the run; one or more.
  bool rests{};                   ///< True if the beam is at rest on the sheet where the run begins.
  /// True if the unit may be held back before the run to wait for the sheet. Implies `rests`.
  bool begins_block{};
};

/// Divides a path with straight jumps: every run begins and ends at rest, every jump begins a block. `path`
/// begins and ends with marks.
std::vector<Run> straightRuns(const std::vector<Segment>& path);

/// Divides a path with jumps as curves (jump_curve.h) of at most this radius. Halves of it, down to an
/// eighth, and the straight jump with a stop at both ends are tried as well, and the one with the least
/// estimated time is taken: a short jump that would have to turn right round takes less time with a stop.
/// Jumps whose stops[k] is set, counted from 0 (missing ones are not), stay straight and begin a block.
/// Corners of marks are rests.
std::vector<Run> smoothRuns(const std::vector<Segment>& path, double radius_mm, const FlowLimits& limits,
                            const std::vector<bool>& stops);

}  // namespace kerfbench::planner

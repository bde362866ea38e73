// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Distance below which ends are the same point.
inline constexpr double kJoinMm = 0.002;

/// Connected entities of one process, end to end.
struct Chain {
  dieline::Process process{dieline::Process::kCut};
  std::vector<Segment> segments;
  int nesting{};  ///< Number of closed cut outlines around the chain.

  [[nodiscard]] const Eigen::Vector2d& start() const { return segments.front().start_mm; }
  [[nodiscard]] const Eigen::Vector2d& end() const { return segments.back().end_mm; }
  [[nodiscard]] bool closed() const { return (start() - end()).norm() < kJoinMm; }
};

/// Joins the entities; where several meet, the straightest continuation is taken. Sets the nesting. With a
/// kerf radius the cuts are those of the beam's centre (kerf.h, which states what it refuses). A closed chain
/// begins at its most downstream corner, or joint if it has no corner.
///
/// All this is done with the whole drawing. What a selection leaves out (dieline::Entity::left_out) is
/// dropped in the end, so that the rest is cut as in the whole job.
std::vector<Chain> joinChains(const dieline::Dieline& dieline, const JobParameters& job,
                              const PlannerFaults& faults);

/// Lists the entities that a selection leaves out.
std::set<int> leftOut(const dieline::Dieline& dieline);

/// Finds the stretches of a chain along the entities that are wanted: all of it, or open ones, which may run
/// through the start of a closed chain.
std::vector<Chain> stretchesOf(const Chain& chain, const std::function<bool(int)>& wanted);

/// Breaks a chain where it turns by more than kTangentRad.
std::vector<Chain> brokenAtCorners(const Chain& chain);

/// Lays a perforation along a chain: between two corners, or ends, a whole number of cuts, the first and the
/// last at the corners, cut and gap scaled by one factor to fit. A closed chain without a corner ends with a
/// gap.
std::vector<Segment> dashed(const Chain& chain, const JobParameters& job);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/offset.h"
#include "firmware_under_test/planner/order/chains.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Largest loss of a narrow feature; more is refused: a fifth of the ±0.05 mm of Cheng et al. 2014.
inline constexpr double kLostMm = 0.01;

struct Compensated {
  /// Cuts along the path of the beam's centre; creases, half-cuts, perforations unchanged.
  std::vector<Chain> chains;
  std::vector<Contour> contours;   ///< Closed and open cuts that were compensated, as drawn.
  Offset offset;                   ///< Offset of the contours.
  std::vector<std::string> notes;  ///< One sentence for each thing that a user should know.
};

/// Offsets the beam by kerf_radius_mm from the cuts, so that the edges of the cut lie on them: outside of
/// outlines, inside of holes (closed cuts within an odd number of others), along open cuts as open_cuts says.
///
/// What the beam is too wide for is never left out without a note: rounded inner corners and features that
/// are lost are notes; a contour without any path, or a narrow feature off by more than kLostMm, is refused
/// unless all of its entities are in allow_lost. An entity there of which nothing is lost is a note as well.
///
/// The chains are those of the whole drawing, for each path depends on the others. Entities of a closed cut
/// that are `left_out` of the job have paths as well, but their losses are not told. @throws PlanError that
/// lists all faults, and cuts, left out or not, that touch or cross themselves or each other.
Compensated compensate(const std::vector<Chain>& chains, const JobParameters& job,
                       const PlannerFaults& faults = {}, const std::set<int>& left_out = {});

/// Compensates a dieline whose chains are not joined yet.
Compensated compensate(const dieline::Dieline& dieline, const JobParameters& job);

}  // namespace kerfbench::planner

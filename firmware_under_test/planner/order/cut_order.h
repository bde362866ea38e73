// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/order/air_path.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Freedom in the order of cutting that a moving sheet may need.
struct OrderOptions {
  /// Break chains at their corners, so that a long outline is cut from downstream to upstream on both sides
  /// rather than round and back to a part of the sheet that has left.
  bool break_at_corners{false};
  /// Keep creases before cuts and holes before outlines only among equals, rather than over the whole unit: a
  /// unit about as long as the field has left it before a second pass could begin.
  bool place_before_process{false};
  /// Largest difference of the downstream ends of pieces that count as equal; the nearest of these comes
  /// first.
  double band_mm{1.0};

  bool operator==(const OrderOptions&) const = default;
};

/// Orders chains by a greedy walk to the nearest end: creases, half-cuts and perforations before cuts, holes
/// before outlines, and on a moving sheet what leaves the field first.
std::vector<Stop> nearestOrder(const dieline::Dieline& dieline, const JobParameters& job,
                               const PlannerFaults& faults, const OrderOptions& options);

/// Stops of each entity by its id, in the sense of the drawing; with a kerf radius they may be several, and
/// none where the entity is lost.
std::map<int, std::vector<Stop>> stopsByEntity(const dieline::Dieline& dieline, const JobParameters& job,
                                               const PlannerFaults& faults);

/// Keeps entities in the order and sense of the drawing. With a kerf radius each has its part of the beam's
/// path round the whole outline; an arc round a corner belongs to one of the two lines that meet there.
std::vector<Stop> drawnOrder(const dieline::Dieline& dieline, const JobParameters& job,
                             const PlannerFaults& faults);

/// Pieces that are cut without switching off; a perforation is one piece with gaps.
std::vector<std::vector<Segment>> piecesOf(const std::vector<Stop>& order, const JobParameters& job);

/// Pieces of nearestOrder().
std::vector<std::vector<Segment>> cutOrder(const dieline::Dieline& dieline, const JobParameters& job,
                                           const PlannerFaults& faults, const OrderOptions& options);

}  // namespace kerfbench::planner

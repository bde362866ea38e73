// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where the wanted piece's edge lies, instead of the kerf's centre line. Private to hil/inspect and its
// tests.

#include <string>
#include <vector>

#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/worst_deviation.h"
#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect::checks {

/// On which side of each entity the kerf must lie so that the edge of the wanted piece is on the dieline.
struct EdgeSides {
  /// Side by entity id: +1 left of the curve in its own sense, -1 right, 0 on it (other processes, and open
  /// cuts that are judged by their centre) or not selected.
  std::vector<int> side;
  int outlines{};     ///< Closed cuts with the kerf outside. What is not selected is not counted.
  int holes{};        ///< With the kerf inside.
  int open{};         ///< Open cuts: they have no inside, and are judged by their centre.
  int open_beside{};  ///< Open cuts beside which the kerf is expected.
  /// Cuts that branch, so that nobody can say which side is the piece.
  std::vector<std::string> problems;
};

/// From the whole drawing, selected or not: entities drawn as cuts are joined where their ends meet
/// (0.02 mm), and a closed cut within an odd number of others is a hole. Edge::kCentre: all 0.
EdgeSides kerfSides(const dieline::Dieline& dieline, Tolerances::Edge edge,
                    Tolerances::OpenCuts open_cuts = Tolerances::OpenCuts::kCentre);

/// The scan with the widths of all kerfs that have an edge as the board is severed, rather than where half of
/// the light comes through: board of transmission T lets half of the light through at a depth of d = 1 -
/// ln((1 + T) / 2) / ln T. A beam of 1/e² radius w that severs to x has the fluence for that depth at sqrt(x²
/// - w²/2 ln d), so the severed half width is sqrt(h² + w²/2 ln d) for h by the light; 0 where it is not
/// severed. What is not known of w, T and the law of depth is common to all kerfs, and added to
/// EntityKerf::widening_sigma_mm.
vision::KerfScan severedScan(const vision::KerfScan& scan, const EdgeSides& sides, double beam_radius_mm,
                             double transmission);

/// The scan as read at the piece's edge: Caliper::offset_mm less side · width / 2, and CornerKerf's deviation
/// by the edges of its own legs. Entities of side 0 stay as they are.
///
/// A corner of the edge is where the edges of its legs meet (mean of the nearest judged calipers), drawn in
/// by what the centre line's rounding r leaves of it: a path that turns by t on an arc has its edge, h nearer
/// to or farther from the arc's centre, rounded by r - h (1 / cos(t/2) - 1) where the piece lies inside of
/// the turn (nothing, if the beam went round it at h), and by r + h (1 / cos(t/2) - 1) where it lies outside:
/// no round beam cuts that sharp. There a leg that runs over cuts into the piece as well.
vision::KerfScan edgeScan(const vision::KerfScan& scan, const dieline::Dieline& dieline,
                          const EdgeSides& sides);

/// Adds to the model of an edgeScan() what the width of each line adds: the edge is one flank of the kerf.
/// `scan` and `sides` must outlive the model.
void addWidthErrors(const vision::KerfScan& scan, const EdgeSides& sides, ErrorModel& model);

/// Adds how well the blur of the picture is known, which moves all edges alike, to what measureDeviations()
/// found. A worst magnitude can change by that shift at most. It is not simulated: where edges lie nearly
/// right, a common shift makes the simulated worst larger and so the corrected one smaller, though the
/// opposite shift of the truth would be hidden just as well.
void addBlurUncertainty(const vision::KerfScan& scan, const EdgeSides& sides, double limit_mm,
                        DeviationResult& result);

/// Half of the mean width of all kerfs with an edge, mm; NaN if there is none.
double halfKerf(const vision::KerfScan& scan, const EdgeSides& sides);

/// Measures the spots against where the beam must run, half_kerf_mm beside the dieline.
void measureFromBeamLine(const EdgeSides& sides, double half_kerf_mm, LitFrames& lit);

/// Measures the spots against where the kerf of their own line lies, on average: stillness is motion, and on
/// a curve a constant distance from it would be seen as one.
void measureFromOwnKerf(const vision::KerfScan& edge_scan, const EdgeSides& sides, LitFrames& lit);

/// Length at an end of an entity along which no kerf is to be expected beside it, mm: in a corner whose kerf
/// lies inside of the turn the beam turns h tan(t/2) before it. Where the other line of the corner is not
/// selected, the corner is the drawing's.
double shortenedBy(const vision::KerfScan& scan, const dieline::Dieline& dieline, const EdgeSides& sides,
                   double half_kerf_mm, const vision::EntityKerf& kerf, bool at_start);

/// pathCheck() of an edgeScan(), named and explained as what it is.
/// `half_light_mm` is halfKerf() by the light; half_kerf_mm as it is severed.
Check edgeCheck(Check path, const EdgeSides& sides, double half_kerf_mm, double half_light_mm);

}  // namespace kerfbench::inspect::checks

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// S0's job, cutting a moving strip to length, by the paper's own formulas: no ramps, no catching up. What
/// the planner finds with ramps is a little worse; what these refuse nothing can do.
struct CrossCut {
  double piece_mm{};         ///< L: length of a piece; > 0.
  double width_mm{};         ///< y0: length of the cut across; > 0.
  double reach_mm{};         ///< x0: of the head along the feed; > 0.
  double feed_mm_s{};        ///< v_x, and of the belt between stops; > 0.
  double cut_mm_s{};         ///< v_y; > 0.
  double reposition_mm_s{};  ///< v_0; > 0.

  /// Way with the strip during a cut: v_x y0 / v_y <= x0.
  [[nodiscard]] double carriedMm() const;
  /// Length of strip that passes during a cut and the way back: (v_x / v_y)(v_x / v_0 + 1) y0 <= L.
  [[nodiscard]] double cycleMm() const;
  /// The highest v_x that both constraints allow.
  [[nodiscard]] double highestFeedMm_s() const;
  /// The constraints that do not hold, with their numbers and the feed each would allow; empty if both hold.
  [[nodiscard]] std::vector<std::string> faults() const;

  /// Until piece n is cut: feed a piece, stop, cut, and so on; n (L / v_x + y0 / v_y).
  [[nodiscard]] double stopAndGoS(double pieces) const;
  /// Until piece n is cut on the strip that never stops: n L / v_x + y0 / v_y.
  [[nodiscard]] double continuousS(double pieces) const;
};

/// The cross cut that a job is, if it is one: a single straight mark, across and along the belt's normal to
/// 1 %, of several units on a belt that moves during the cut.
std::optional<CrossCut> crossCutOf(const std::vector<Segment>& path, const MachineParameters& machine,
                                   const JobParameters& job);

/// S0's comparison as a table: what the formulas say and what the planner needs with its ramps, both ways,
/// for 1, 100, 1000 and 10 000 pieces. @throws PlanError that lists every constraint that does not hold.
std::string throughputTable(const CrossCut& cut, const MachineParameters& machine, const JobParameters& job);

}  // namespace kerfbench::planner

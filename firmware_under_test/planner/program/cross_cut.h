// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Job of S0, cutting a moving strip to length, by the paper's own formulas: no ramps, no catching up. With
/// ramps the planner finds a little less; what these formulas refuse is impossible.
struct CrossCut {
  double piece_mm{};         ///< Length L of a piece; > 0.
  double width_mm{};         ///< Length y0 of the cut across; > 0.
  double reach_mm{};         ///< Reach x0 of the head along the feed; > 0.
  double feed_mm_s{};        ///< Feed v_x, and speed of the belt between stops; > 0.
  double cut_mm_s{};         ///< Cutting speed v_y; > 0.
  double reposition_mm_s{};  ///< Return speed v_0; > 0.

  /// Distance travelled with the strip during a cut: v_x y0 / v_y <= x0.
  [[nodiscard]] double carriedMm() const;
  /// Length of strip that passes during a cut and the return: (v_x / v_y)(v_x / v_0 + 1) y0 <= L.
  [[nodiscard]] double cycleMm() const;
  /// Highest v_x that both constraints allow.
  [[nodiscard]] double highestFeedMm_s() const;
  /// Values that are not > 0 and finite, a sentence each.
  [[nodiscard]] std::vector<std::string> unusable() const;
  /// Unusable values, or constraints that do not hold, with their numbers and the feed each would allow;
  /// empty if both hold.
  [[nodiscard]] std::vector<std::string> faults() const;

  /// Time until piece n is cut by feeding a piece, stopping, cutting, and so on; n (L / v_x + y0 / v_y).
  [[nodiscard]] double stopAndGoS(double pieces) const;
  /// Time until piece n is cut on the strip that never stops: n L / v_x + y0 / v_y.
  [[nodiscard]] double continuousS(double pieces) const;
};

/// Cross cut that a job is, if it is one: a single straight mark, across and along the belt's normal to 1 %,
/// of several units on a belt that moves during the cut.
std::optional<CrossCut> crossCutOf(const std::vector<Segment>& path, const MachineParameters& machine,
                                   const JobParameters& job);

}  // namespace kerfbench::planner

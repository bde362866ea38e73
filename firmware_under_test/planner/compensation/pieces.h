// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "firmware_under_test/planner/compensation/curves.h"
#include "firmware_under_test/planner/compensation/offset.h"

namespace kerfbench::planner {

/// A piece of curve that the beam's path may follow, in the sense of its contour.
struct OffsetPiece {
  Segment curve;
  std::size_t contour{};
  std::size_t segment{};  ///< Segment of the contour.
  double side{};          ///< +1: the beam runs to the left of the contour.
  bool joint{};           ///< True if the piece belongs to the joint at the segment's end.
};

/// A segment with its box, for fast search.
struct Boxed {
  Segment curve;
  Eigen::AlignedBox2d box;
  double slack_mm;  ///< Rounding error of a distance to the segment.
};
Boxed boxed(const Segment& curve);
std::vector<Boxed> boxed(const std::vector<Contour>& contours);

/// True if no curve is nearer to p than `radius_mm`, except for rounding.
bool isFree(const std::vector<Boxed>& obstacles, const Eigen::Vector2d& p_mm, double radius_mm);

/// Offset of one segment; nullopt where an arc is too tight for it.
std::optional<Segment> offsetOf(const Segment& segment, double side, double radius_mm);

/// The joint after segment i.
Joint jointAfter(const Contour& contour, std::size_t i);

/// Offsets of all segments and their joints, before anything is cut. Sets the joints' kinds.
std::vector<OffsetPiece> rawPieces(const std::vector<Contour>& contours, const std::vector<Boxed>& obstacles,
                                   double radius_mm, std::vector<Joint>& joints);

/// Links pieces end to end. @throws CompensationError for closed contours where an end meets no other.
std::vector<BeamPath> stitched(std::vector<OffsetPiece> pieces, const std::vector<Contour>& contours);

/// Stretches of the contours that the paths do not cut. `kept` holds the offset pieces that remained.
std::vector<LostStretch> lostStretches(const std::vector<Contour>& contours,
                                       const std::vector<OffsetPiece>& kept,
                                       const std::vector<BeamPath>& paths, double radius_mm);

}  // namespace kerfbench::planner

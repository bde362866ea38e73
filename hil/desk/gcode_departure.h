// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// A line of G-code whose cut is not on the drawing.
struct GcodeDeparture {
  int line{};
  double off_mm{};  ///< Largest distance; kFarthestLooked_mm: that far or farther.
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Place of it.
};

/// A piece of the drawing that no line cuts.
struct UncutPiece {
  int entity{-1};
  double length_mm{};
};

struct GcodeComparison {
  std::vector<GcodeDeparture> departures;  ///< In the order of the lines.
  std::vector<UncutPiece> uncut;           ///< In the order in which they would be cut.
};

/// Distances are looked for as far as this.
inline constexpr double kFarthestLooked_mm = 2.0;
/// Distance of the places of a cut that are looked at.
inline constexpr double kLookEvery_mm = 0.25;

/// Holds the cuts of a G-code against those that the planner makes of the drawing, with its kerf: each place
/// of either must have one of the other within `within_mm`. Ends that run over by less than that, and pieces
/// of the drawing shorter than three looks, are passed by.
GcodeComparison comparedWithPlan(const std::vector<planner::Segment>& gcode,
                                 const std::vector<planner::Segment>& planned, double within_mm);

}  // namespace kerfbench::desk

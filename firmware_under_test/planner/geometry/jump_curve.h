// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Ends that a jump joins; unit directions are those of travel, out of one mark and into the next.
struct JumpEnds {
  Eigen::Vector2d from_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d from_direction{Eigen::Vector2d::UnitX()};
  Eigen::Vector2d to_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d to_direction{Eigen::Vector2d::UnitX()};
};

/// Sides on which the two circles of a jump lie, seen along the travel: +1 left (counter-clockwise), -1
/// right.
struct JumpSides {
  int first{};
  int second{};
};

/// Arc, line and arc of one radius, tangent to both marks, with the circles on the given sides; pieces of no
/// length are left out, so marks that lie on one line are joined by the line alone. Never empty, unless the
/// ends coincide with equal directions: then no jump is needed. nullopt if circles on different sides
/// overlap, which leaves them without the common tangent for these senses.
///
/// Exactly one of the four common tangents of two circles has the sense of rotation of the marks at both (S2,
/// W1 and W2): the one that leaves the first circle in the beam's direction of turning and meets the second
/// in its direction. @throws std::invalid_argument unless radius_mm > 0.
std::optional<std::vector<Segment>> jumpOver(const JumpEnds& ends, double radius_mm, JumpSides sides);

/// Jump by S2's choice: of the four pairs of circles the one with the nearest centres. Where it has no
/// tangent (the circles overlap) or leads round by more than longestJumpMm(), the next nearest; equal
/// distances are decided by length. nullopt if no pair serves: take a smaller radius, or stop.
std::optional<std::vector<Segment>> smoothJump(const JumpEnds& ends, double radius_mm);

/// Longest jump that smoothJump() accepts: the straight distance and one full turn.
double longestJumpMm(const JumpEnds& ends, double radius_mm);

double lengthOf(const std::vector<Segment>& path);

/// Radius that the paper found by experiment: 1 mm for drawings to 10 x 10 mm, 5 mm to 100 x 100 mm, by the
/// larger side; in between and below it grows in proportion to the logarithm (10 mm to 1 mm, 100 mm to 5 mm),
/// never above 5 mm: the radius follows from speed and acceleration (v² / a), and neither grows with the
/// drawing.
double paperRadiusMm(double larger_side_mm);

}  // namespace kerfbench::planner

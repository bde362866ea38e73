// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::hil {

/// A corner as cut, about the nominal one in the origin. Its legs are parallel to the nominal ones.
struct CornerShape {
  Eigen::Vector2d tangent_in{Eigen::Vector2d::UnitX()};   ///< Unit, of the way towards the corner.
  Eigen::Vector2d tangent_out{Eigen::Vector2d::UnitY()};  ///< Unit, away from it.
  Eigen::Vector2d vertex_mm{Eigen::Vector2d::Zero()};     ///< Where the legs as cut would meet.
  double rounding_mm{};  ///< An arc that touches both legs passes so far inside of the vertex; >= 0.
  double over_in_mm{};   ///< By how much the leg that comes in runs on beyond the vertex; >= 0.
  double over_out_mm{};  ///< How far before it the leg that goes out begins; >= 0.
};

/// Where two lines meet that lie `offset_in_mm` and `offset_out_mm` to the left of the nominal legs.
/// The legs must not be parallel.
Eigen::Vector2d vertexOf(const Eigen::Vector2d& tangent_in, double offset_in_mm,
                         const Eigen::Vector2d& tangent_out, double offset_out_mm);

/// How far before the vertex an arc begins that passes so far inside of it.
double arcLegMm(double turn_rad, double rounding_mm);

/// Hausdorff distance of the corner's two ways, the nominal one and that of the beam: the farthest that any
/// place of one lies from the other. Legs count as far as the arc or a run-over reaches; farther out they are
/// measured by calipers.
double deviationMm(const CornerShape& shape);

}  // namespace kerfbench::hil

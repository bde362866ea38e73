// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// A B-spline curve, rational where the weights differ.
struct Nurbs {
  int degree{3};
  std::vector<double> knots;  ///< points + degree + 1 values, not decreasing.
  std::vector<Eigen::Vector2d> control_mm;
  std::vector<double> weights;  ///< One per control point, all > 0.
};

/// Rational cubic Béziers of exactly the same curve, one per knot span that is not empty; degree 1 gives
/// lines.
/// @throws std::invalid_argument, saying what is wrong: degree outside 1…3, counts that do not fit, knots
/// that decrease or break the curve, weights that are not positive.
std::vector<Curve> toBeziers(const Nurbs& spline);

}  // namespace kerfbench::dieline

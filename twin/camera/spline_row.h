// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "twin/camera/spline_weights.h"

namespace kerfbench::twin {

/// Most places of a row.
inline constexpr std::size_t kMostInRow = 128;
using RowValues = std::array<float, kMostInRow>;

/// Coefficients of a uniform cubic B-spline, row by row.
struct SplineNodes {
  const float* first;
  int columns;
};

/// The spline's values at `count` places, counted from its first node: the same as splineValue() has with the
/// table's weights. All of a place's 4 x 4 coefficients must be there.
void splineValues(const SplineNodes& nodes, const SplineWeightTable& weights, const RowValues& x,
                  const RowValues& y, std::size_t count, RowValues& out);

/// How far each line of sight is above zero on its way from one slice to the next, both ends being heights on
/// a straight line; adds that times `length` to `sums`.
void addAboveZero(const RowValues& from, const RowValues& to, float length, std::size_t count,
                  RowValues& sums);

}  // namespace kerfbench::twin

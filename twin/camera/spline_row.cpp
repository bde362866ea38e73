// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/spline_row.h"

#include <algorithm>
#include <cmath>

#include "twin/base/multiversion.h"

namespace kerfbench::twin {
namespace {

KERFBENCH_WIDE void fillWithValues(const SplineNodes& nodes, const SplineWeightTable& weights,
                                   const RowValues& x, const RowValues& y, std::size_t count,
                                   RowValues& out) {
  // Where the coefficients and the weights of each place begin.
  std::array<int, kMostInRow> node, weights_x, weights_y;
  for (std::size_t i = 0; i < count; ++i) {
    const int column = static_cast<int>(x[i]);
    const int row = static_cast<int>(y[i]);
    node[i] = (row - 1) * nodes.columns + (column - 1);
    weights_x[i] = SplineWeightTable::indexOf(x[i] - static_cast<float>(column));
    weights_y[i] = SplineWeightTable::indexOf(y[i] - static_cast<float>(row));
  }
  const auto stride = static_cast<std::size_t>(nodes.columns);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = splineValue(nodes.first + node[i], stride, weights.of(weights_x[i]), weights.of(weights_y[i]));
}

KERFBENCH_WIDE void addParts(const RowValues& from, const RowValues& to, float length, std::size_t count,
                             RowValues& sums) {
  for (std::size_t i = 0; i < count; ++i) {
    const float a = from[i];
    const float b = to[i];
    const bool below = a <= 0.0F && b <= 0.0F;
    const bool above = a >= 0.0F && b >= 0.0F;
    const float crossing = std::max(a, b) / std::abs(b - a);
    sums[i] += length * (below ? 0.0F : above ? 1.0F : crossing);
  }
}

}  // namespace

void splineValues(const SplineNodes& nodes, const SplineWeightTable& weights, const RowValues& x,
                  const RowValues& y, std::size_t count, RowValues& out) {
  fillWithValues(nodes, weights, x, y, count, out);
}

void addAboveZero(const RowValues& from, const RowValues& to, float length, std::size_t count,
                  RowValues& sums) {
  addParts(from, to, length, count, sums);
}

}  // namespace kerfbench::twin

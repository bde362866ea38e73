// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "twin/sheet/cubic_spline.h"

namespace kerfbench::twin {

/// A two-dimensional Gaussian on the nodes of the map; unit: the spacing of the nodes.
struct GaussianFootprint {
  Eigen::Vector2d centre{Eigen::Vector2d::Zero()};
  double variance_x{}, variance_y{}, covariance{};
};

/// Footprint whose coefficients of the cubic B-spline give `footprint`: narrower by the spline's own
/// variance, but no narrower than its samples can carry. Axes and centre stay.
GaussianFootprint splineCoefficientsOf(GaussianFootprint footprint);

/// A Gaussian sampled at whole nodes, row by row, ready to be added to the map:
///
///     exp(-(a i² + 2 b i j + c j²)) = X(i) Y(j) g^(i j)
///
/// all three by recurrence, so that a dozen exponentials are enough for any number of nodes. The powers of g
/// stay in range only for a correlation of no more than kMaxCorrelation.
class SampledBell {
 public:
  static constexpr double kMaxCorrelation = 0.5;
  /// Reach of the samples in standard deviations: 1e-5 of the peak and 3e-6 of the volume are beyond.
  static constexpr double kReach = 4.8;

  /// Value at column first_column + 4 k + l of the row: columns[k][l] * start[l] * step^k.
  struct Row {
    Quad start;
    float step;
  };

  /// Samples `bell` so that all samples add up to `sum`, within 1e-5.
  void sample(const GaussianFootprint& bell, double sum);

  /// First column that is sampled; a multiple of four.
  [[nodiscard]] int firstColumn() const { return first_column_; }
  [[nodiscard]] int firstRow() const { return first_row_; }
  [[nodiscard]] const std::vector<Quad>& columns() const { return columns_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  void scaleTo(double sum);

  int first_column_{}, first_row_{};
  std::vector<Quad> columns_;
  std::vector<Row> rows_;
};

}  // namespace kerfbench::twin

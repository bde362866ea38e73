// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "hil/calibrate/tables/aim_grid.h"

namespace kerfbench::calibrate {

/// Distances between two tables' aims over some places.
struct AimDifference {
  double max_um{};
  double rms_um{};
  Eigen::Vector2d worst_W_mm{Eigen::Vector2d::Zero()};  ///< Place of the largest.
  std::size_t places{};
};

/// Loss of a table by its conversion into another format: |d' − d|, to first order the distance by which the
/// beam lands elsewhere.
struct TableLoss {
  AimDifference nodes;        ///< Difference at the new nodes, by rounding of the numbers.
  AimDifference mid_cell;     ///< Difference in the middles of the new cells.
  AimDifference rim;          ///< Difference along the new border, eight places a cell.
  AimDifference anywhere;     ///< Five by five places in each new cell, its border included.
  std::size_t not_covered{};  ///< Places that the original does not cover; not counted above.
  double covered_share{};     ///< Share of the original's area that the new nodes cover.
  /// Report in lines, the largest differences with their places.
  [[nodiscard]] std::string text() const;
};

TableLoss tableLoss(const AimGrid& original, const AimGrid& converted);

}  // namespace kerfbench::calibrate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/head_fit.h"

namespace kerfbench::hil {

/// A correction over an even grid, as the controller understands it: for a beam wanted at p the head is aimed
/// at p + d(p). Between nodes a bicubic Hermite surface, whose slopes at the nodes are those of the
/// polynomial through five neighbours; no extrapolation: beyond the grid the value of the nearest place on
/// its border.
class CorrectionGrid {
 public:
  /// `d_mm`: y ascending, and for each y all x ascending.
  /// @throws std::invalid_argument for fewer than 5 x 5 or more than 1025 x 1025 nodes, an empty area, or
  ///   another number of values.
  CorrectionGrid(const Eigen::AlignedBox2d& area_W_mm, int columns, int rows,
                 const std::vector<Eigen::Vector2d>& d_mm);

  [[nodiscard]] const Eigen::AlignedBox2d& area_W_mm() const { return area_W_mm_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] Eigen::Vector2d place_W_mm(int column, int row) const;
  [[nodiscard]] const Eigen::Vector2d& d_mm(int column, int row) const;
  [[nodiscard]] Eigen::Vector2d at_mm(const Eigen::Vector2d& p_W_mm) const;

 private:
  /// d, its slopes by column and by row, and both; per cell.
  struct Node {
    Eigen::Vector2d d, by_u, by_v, by_uv;
  };
  [[nodiscard]] const Node& node(int column, int row) const {
    return nodes_[static_cast<std::size_t>(row * columns_ + column)];
  }
  void setSlopes();

  Eigen::AlignedBox2d area_W_mm_;
  int columns_, rows_;
  std::vector<Node> nodes_;
};

struct CorrectionGridOptions {
  Eigen::AlignedBox2d field_W_mm{};      ///< Where the beam shall land.
  double margin_share{0.02};             ///< The grid reaches beyond the field by this share of its sides.
  double interpolation_error_mm{0.001};  ///< No more in any cell's middle or an edge's; > 0.
  int least_nodes{9}, most_nodes{129};   ///< Of a side; 5 … 1025.
};

struct CorrectionTableResult {
  CorrectionGrid grid;
  double interpolation_error_mm{};  ///< Largest found, of the landing, over middles and edges of all cells.
  double largest_correction_mm{};
  double largest_sigma_mm{};  ///< Of where the beam lands, in its worst direction, over the nodes; k = 1.
};

/// The table of this head: the coarsest of 2^k + 1 nodes a side whose surface is good enough.
/// @throws HeadCalibrationError where the beam does not get to, where no grid is fine enough, and where two
///   places want the same aim.
CorrectionTableResult correctionTable(const HeadFit& fit, const CorrectionGridOptions& options);

}  // namespace kerfbench::hil

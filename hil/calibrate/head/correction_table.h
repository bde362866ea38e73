// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/tables/aim_grid.h"

namespace kerfbench::calibrate {

struct CorrectionTableOptions {
  Eigen::AlignedBox2d field_W_mm{};      ///< Field in which the beam shall land.
  double margin_share{0.02};             ///< The grid reaches beyond the field by this share of its sides.
  double interpolation_error_mm{0.001};  ///< Largest error in the middle of any cell or edge; > 0.
  /// A controller that knows nothing but the nodes must not find the grid too coarse: in the middle between
  /// two of them, cubics through neighbouring sets of four differ by no more; > 0. The reference controller
  /// refuses 0.01.
  double cubics_differ_mm{0.005};
  int least_nodes{9}, most_nodes{129};  ///< Fewest and most nodes of a side; 5 … 1025.
};

struct CorrectionTableResult {
  AimGrid grid;                     ///< Even, between its nodes as the controller reads it, nothing outside.
  double interpolation_error_mm{};  ///< Largest found, of the landing, over middles and edges of all cells.
  double largest_correction_mm{};
  double largest_sigma_mm{};  ///< Largest standard deviation of where the beam lands, in its worst direction,
                              ///< over the nodes; k = 1.
};

/// The table of this head: the coarsest of 2^k + 1 nodes a side whose surface is good enough.
/// @throws HeadCalibrationError where the beam does not get to, where no grid is fine enough, and where two
///   places want the same aim.
CorrectionTableResult correctionTable(const HeadFit& fit, const CorrectionTableOptions& options);

}  // namespace kerfbench::calibrate

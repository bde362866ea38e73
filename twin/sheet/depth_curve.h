// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/sheet/board_description.h"

namespace kerfbench::twin {

/// S3's D = f(P_ua) of a board, over the fluence: piecewise linear, 0 up to the threshold, 1 from the fluence
/// that cuts through. Immutable.
class DepthCurve {
 public:
  /// Makes the curve of a board without faults, see faultsOf().
  explicit DepthCurve(const BoardDescription& board);
  /// Burnt depth over thickness, 0…1, of board that absorbed `fluence_j_mm2`.
  [[nodiscard]] double depthAt(double fluence_j_mm2) const;
  /// The same with the curve's first and last piece going on as straight lines: below 0 where nothing is
  /// burnt yet, above 1 where the board is through. Between places on a wall this is straight where depth is
  /// not.
  [[nodiscard]] double unboundedDepthAt(double fluence_j_mm2) const;
  /// Fluence that burns to `depth_share`; the threshold for 0 and less, cut_fluence_j_mm2 for 1 and more.
  [[nodiscard]] double fluenceFor_j_mm2(double depth_share) const;

 private:
  std::vector<DepthPoint> points_;  ///< Points of the curve; two or more.
  double cut_fluence_j_mm2_;
};

}  // namespace kerfbench::twin

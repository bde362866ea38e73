// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::twin {

/// The board and how a CO2 beam eats it.
struct BoardDescription {
  double thickness_mm{0.4};
  /// Energy per area (J/mm²), summed over all passes, at which the board is just cut through. Depth grows linearly
  /// with it up to there (S3: D = f(P_ua), linear before saturation).
  double cut_fluence_j_mm2{0.5};
  double transmission{0.12};  ///< Of the back light through uncut board, 0…1.
  double print_transmission{0.02};  ///< Through board under a registration mark.
};

/// The beam on the sheet during a short time: an elliptical Gaussian.
struct Footprint {
  Eigen::Vector2d p_SQ_mm{Eigen::Vector2d::Zero()};  ///< Centre on the web, in S of unit 0.
  double radius_x_mm{0.105};  ///< 1/e² radius along Sx.
  double radius_y_mm{0.105};
};

/// The web as a map of absorbed energy, sparse, on a grid of kCellMm. The peak of a line cut at power P and speed v is
/// P/v * sqrt(2/pi) / w for a round spot of radius w.
class Sheet {
 public:
  static constexpr double kCellMm = 0.02;

  explicit Sheet(const BoardDescription& board);

  /// The beam moved straight from `from` to `to` while it delivered `energy_j`.
  void burn(const Footprint& from, const Footprint& to, double energy_j);

  /// Absorbed energy at a point, J/mm²; smooth between the cells (bicubic or better than 1e-3 of the peak).
  [[nodiscard]] double fluenceAt(const Eigen::Vector2d& p_S_mm) const;
  /// Burnt depth over thickness, 0 untouched … 1 cut through.
  [[nodiscard]] double depthAt(const Eigen::Vector2d& p_S_mm) const;
  [[nodiscard]] const BoardDescription& board() const { return board_; }
  /// True if nothing was burnt within the box.
  [[nodiscard]] bool untouched(const Eigen::Vector2d& min_S_mm, const Eigen::Vector2d& max_S_mm) const;

 private:
  BoardDescription board_;
  // sparse tiles
};

}  // namespace kerfbench::twin

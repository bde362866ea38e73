// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::twin {

/// A square marker in one white square of a target (ChArUco).
struct TargetMarker {
  int column{}, row{};  ///< Column and row of its square.
  /// Colour of each cell, row by row as printed, border included: 0 black, else white.
  std::vector<std::uint8_t> white;
};

/// A flat calibration target: a chessboard of black and white squares on white paper, with markers in its
/// white squares or without.
///
/// Frame B: origin at the outer corner of square (0, 0), x along the columns, y along the rows, z into the
/// paper: an observer of the print has x to the right and y down, as in a picture. Square (i, j) covers [i, i
/// + 1] x [j, j + 1] times square_mm.
struct TargetBoard {
  int columns{}, rows{};      ///< Number of squares; 2 … 200.
  double square_mm{};         ///< > 0
  bool first_is_black{true};  ///< Colour of square (0, 0); its neighbours are of the other colour, and so on.
  double margin_mm{10.0};     ///< White paper around the squares; >= 0.
  double marker_mm{};  ///< Side of a marker, in the middle of its square; in (0, square_mm) with markers.
  int marker_cells{};  ///< Cells along a side, border included; 1 … 32 with markers.
  std::vector<TargetMarker> markers;
  double white_gray{200.0};  ///< Grey levels as the camera sees them under its light; in [0, 255].
  double black_gray{20.0};
  double around_gray{60.0};  ///< Grey of the surroundings of the paper.
};

/// Everything that is wrong with a board, in one line; empty when nothing is.
std::string faultsOf(const TargetBoard& board);

/// The print as a lattice of cells of one grey each, with its Gaussian blur. Immutable.
class TargetPattern {
 public:
  /// @throws std::invalid_argument that names everything wrong with the board.
  explicit TargetPattern(const TargetBoard& board);

  /// Scratch of blurredAt(), one for each thread.
  struct Scratch {
    std::vector<double> share_x, share_y, scaled_x, scaled_y;
  };
  /// Mean grey around p_B_mm, weighted by a Gaussian of this covariance (mm²; positive definite). Exact to
  /// 1e-5 of the contrast for correlations up to 0.8, whatever the place: edges and corners have no grid.
  [[nodiscard]] double blurredAt(const Eigen::Vector2d& p_B_mm, const Eigen::Matrix2d& covariance_mm2,
                                 Scratch& scratch) const;
  [[nodiscard]] double around() const { return gray_.front(); }
  /// Grey at a place, without blur.
  [[nodiscard]] double grayAt(const Eigen::Vector2d& p_B_mm) const;

 private:
  class Print;
  /// Places of the lattice's lines along one axis, ascending.
  struct Lines {
    std::vector<double> at_mm;
    std::vector<std::size_t> bucket;  ///< First line of each stretch of bucket_mm from the first line on.
    double bucket_mm{};
    void finish();
    /// Number of lines at or below the place.
    [[nodiscard]] std::size_t below(double place_mm) const;
  };
  [[nodiscard]] double cell(std::size_t column, std::size_t row) const {
    return gray_[row * (x_.at_mm.size() + 1) + column];
  }

  Lines x_, y_;
  std::vector<double> gray_;  ///< Grey of each cell, (lines of x + 1) * (lines of y + 1).
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

namespace kerfbench::calibrate {

/// A ChArUco target: a chessboard, square (0, 0) black, with a marker in the middle of each white square. The
/// markers are those of OpenCV's dictionary 5X5_1000, numbered row by row.
///
/// Frame B: origin at the outer corner of square (0, 0), x along the columns, y along the rows, z into the
/// paper: whoever looks at the print has x to the right and y down.
struct CalibrationTarget {
  static constexpr int kMarkerCells = 7;  ///< Along a side, black border included.
  static constexpr int kMostMarkers = 1000;

  int columns{};       ///< Squares; 4 … 200.
  int rows{};          ///< 4 … 200
  double square_mm{};  ///< Side of a square, as measured on the print; 0.1 … 1000.
  double marker_mm{};  ///< Side of a marker; 0.4 … 0.8 of a square: around it a corner must be free.

  /// Everything that is wrong, in one line; empty when nothing is.
  [[nodiscard]] std::string faults() const;
  [[nodiscard]] int markers() const { return columns * rows / 2; }
  [[nodiscard]] int innerCorners() const { return (columns - 1) * (rows - 1); }
  [[nodiscard]] Eigen::Vector2d size_mm() const { return square_mm * Eigen::Vector2d(columns, rows); }

  /// Column and row of the square that holds the marker. @throws std::out_of_range for no marker of this
  /// target.
  [[nodiscard]] Eigen::Vector2i squareOf(int marker) const;
  /// The marker in a square; -1 for a black square or none.
  [[nodiscard]] int markerIn(int column, int row) const;
};

/// The smallest target of handy squares that covers `field_mm` (> 0) with `margin` (share of each side) and
/// whose squares are no smaller than `least_square_mm`.
CalibrationTarget targetFor(const Eigen::Vector2d& field_mm, double margin, double least_square_mm);

}  // namespace kerfbench::calibrate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace kerfbench::vision {

/// Samples of a picture, two per pixel each way and some pixels beyond its border, and what a lens makes
/// pixels of.
///
/// Each row of samples holds all even columns, then all odd ones: the loops that weigh neighbours then run
/// over neighbours in memory.
class CornerRaster {
 public:
  CornerRaster(int pixel_columns, int pixel_rows);

  static constexpr int kSamples = 2;   ///< Per pixel, each way.
  static constexpr int kMarginPx = 3;  ///< Around the picture, for the blur.

  [[nodiscard]] int columns() const { return kSamples * plane_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row * stride_ + column % kSamples * padded_ + column / kSamples);
  }
  /// Number of samples with those that only fill up rows.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(rows_ * stride_); }

  /// Pixels of samples after a blur by a Gaussian, row by row. The samples that a pixel averages over count
  /// for a part of the blur.
  void average(const std::vector<float>& samples, double blur_px, std::vector<float>& pixels);

 private:
  int pixel_columns_, pixel_rows_;
  int plane_, padded_;  ///< Columns of one kind, and with what fills them up.
  int stride_, rows_;
  std::vector<float> lines_;  ///< Rows of pixels, columns of samples.
  std::vector<float> line_;   ///< A row of pixels, filled up.
};

}  // namespace kerfbench::vision

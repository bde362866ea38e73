// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Board brightness over the picture on a coarse grid, and the noise of a pixel.
class Background {
 public:
  static constexpr int kCellPx = 64;

  explicit Background(const GrayImage& image) : Background(image, {}) {}
  /// Samples a picture and calls visit(top, bottom) for each band of rows [top, bottom) just before it is
  /// sampled, so that work on the whole picture reads its memory only once.
  Background(const GrayImage& image, const std::function<void(int, int)>& visit);

  /// Board gray around a pixel: the median of its cell, or of the cells
  /// around where something dark covers it.
  [[nodiscard]] int at(int column, int row) const {
    return level_[static_cast<std::size_t>((row - top_) / kCellPx) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>((column - left_) / kCellPx)];
  }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Median of the whole picture.
  [[nodiscard]] int median() const { return median_; }
  /// Standard deviation of one pixel of plain board.
  [[nodiscard]] double noise() const { return noise_; }
  /// Share of the picture at the top of the scale.
  [[nodiscard]] double saturatedShare() const { return saturated_share_; }
  /// True where no two neighbours differ anywhere: not the picture of a sensor.
  [[nodiscard]] bool lifeless() const { return lifeless_; }

 private:
  int left_{}, top_{};
  int columns_{};
  int rows_{};
  std::vector<int> level_;
  int median_{};
  double noise_{};
  double saturated_share_{};
  bool lifeless_{};
};

/// A place that stands out of the board.
struct BrightPeak {
  int column{};
  int row{};
  int height{};  ///< Mean of 2 x 2 pixels above the board.
};

struct BrightnessScan {
  Background background;
  std::vector<BrightPeak> peaks;
};

/// The background and the brightest places of the picture, at most `max`, brightest first and never two in
/// touching cells. Each stands out of the noise of millions of pixels: by means of 2 x 4 pixels on every
/// second row, so a spot as small as the optics makes it is seen wherever it lies between the pixels. The
/// picture is read by every other row, and cells by all of theirs where these hint at a spot; that hides none
/// of 0.8 px (standard deviation) and more, and sharper ones only where the means of 2 x 4 pixels hardly show
/// them. Small windows have levelsOf() and brightestOf().
BrightnessScan scanBrightness(const GrayImage& image, std::size_t max);

}  // namespace kerfbench::vision

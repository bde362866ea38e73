// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "hil/vision/image/brightness_scan.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Levels of the windows of one frame together.
struct WindowLevels {
  int median{};    ///< Most of it is board, as long as the windows are larger than what is printed there.
  double noise{};  ///< Standard deviation of one pixel of plain board.
  double saturated_share{};  ///< Share of the pixels at the top of the scale.
  bool lifeless{};           ///< No two neighbours differ anywhere: not of a sensor.
};

/// Levels of all windows; those without pixels do not count.
WindowLevels levelsOf(std::span<const GrayImage> windows);
/// Median of one window; 0 of one without pixels.
int medianOf(const GrayImage& window);

/// The brightest mean of 2 x 2 pixels, if it stands out of the noise; its height is above `board`. Places
/// around those in `tried` do not count.
std::optional<BrightPeak> brightestOf(const GrayImage& window, int board, double noise,
                                      std::span<const BrightPeak> tried);

}  // namespace kerfbench::vision

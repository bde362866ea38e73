// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "twin/base/image.h"
#include "twin/camera/camera.h"

namespace kerfbench::twin {

/// Effect of lamp, lens and sensor on whole pictures of light: uneven light and hot pixels.
class PictureShading {
 public:
  explicit PictureShading(const CameraDescription& camera);

  struct HotPixel {
    int x{}, y{};
    float gray{};  ///< Grey that the pixel adds.
  };

  /// True if light is the same all over the picture.
  [[nodiscard]] bool even() const { return !lamp_ && !lens_; }
  /// Shades a window of a picture of light that the lamp throws: board and print, not the glowing spot.
  void shadeByLamp(const PixelWindow& window, std::span<float> light) const;
  /// Shades a window of a picture of all light.
  void shadeByLens(const PixelWindow& window, std::span<float> light) const;
  /// Adds the hot pixels to a whole picture; the last step.
  void addHotPixels(std::span<float> picture) const;
  /// Hot pixels in order of row and column, each once.
  [[nodiscard]] const std::vector<HotPixel>& hotPixels() const { return hot_; }

 private:
  int width_, height_;
  UnevenLight light_;
  bool lamp_, lens_;
  std::vector<HotPixel> hot_;
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kerfbench {

/// A grey image, row-major without padding. Pixel centres are at integer coordinates, as in OpenCV:
/// pixel (0, 0) covers [-0.5, 0.5] in both directions.
struct GrayImage {
  int width{};
  int height{};
  std::vector<std::uint8_t> pixels;  ///< width * height

  GrayImage() = default;
  GrayImage(int w, int h, std::uint8_t value = 0)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  [[nodiscard]] std::uint8_t& at(int column, int row) { return pixels[index(column, row)]; }
  [[nodiscard]] std::uint8_t at(int column, int row) const { return pixels[index(column, row)]; }
  [[nodiscard]] std::span<std::uint8_t> row(int r) {
    return std::span(pixels).subspan(index(0, r), static_cast<std::size_t>(width));
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

/// One exposure of a camera.
struct Frame {
  GrayImage image;
  std::uint64_t sequence{};  ///< Counts exposures, so that a dropped frame shows as a gap.
  double start_s{};          ///< Begin of exposure on the clock of the pins.
  double exposure_s{};       ///< > 0
};

}  // namespace kerfbench

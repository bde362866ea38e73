// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace kerfbench {

/// A box of pixels of a picture.
struct PixelWindow {
  int left{}, top{};
  int width{}, height{};
  [[nodiscard]] int right() const { return left + width - 1; }  ///< Last column.
  [[nodiscard]] int bottom() const { return top + height - 1; }
  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  [[nodiscard]] std::size_t area() const {
    return empty() ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  friend constexpr bool operator==(const PixelWindow&, const PixelWindow&) = default;
  /// What lies in both.
  [[nodiscard]] PixelWindow within(const PixelWindow& other) const {
    const int l = std::max(left, other.left);
    const int t = std::max(top, other.top);
    return {l, t, std::min(right(), other.right()) - l + 1, std::min(bottom(), other.bottom()) - t + 1};
  }
};

/// A grey image, row-major without padding. Pixel centres are at integer coordinates, as in OpenCV: pixel
/// (0, 0) covers [-0.5, 0.5] in both directions. It may be a window of a larger picture: columns and rows are
/// then those of the whole picture, from left to right() and from top to bottom().
///
/// Grey is in units of the 8-bit scale at every depth: level n of a picture of 10 bits is grey n / 4, of 12
/// bits n / 16. A picture of more than 8 bits keeps its levels and holds the same picture rounded to 8 bits,
/// computed once: code that scans a whole picture reads `pixels`, code that measures reads gray().
struct GrayImage {
  int width{};
  int height{};
  int left{};                         ///< First column; 0 unless the image is a window.
  int top{};                          ///< First row.
  int bits{8};                        ///< 8, 10 or 12.
  std::vector<std::uint8_t> pixels;   ///< width * height
  std::vector<std::uint16_t> levels;  ///< width * height of 0 … 2^bits - 1; empty when bits is 8.

  GrayImage() = default;
  GrayImage(int w, int h, std::uint8_t value = 0) : width(w), height(h), pixels(areaOf(w, h), value) {}
  /// A picture of more than 8 bits. @throws std::invalid_argument for other depths, a level beyond its depth,
  /// or a number of levels that is not w * h.
  static GrayImage ofLevels(int w, int h, int depth_bits, std::vector<std::uint16_t> levels_of_pixels);

  [[nodiscard]] std::uint8_t& at(int column, int row) { return pixels[index(column, row)]; }
  [[nodiscard]] std::uint8_t at(int column, int row) const { return pixels[index(column, row)]; }
  [[nodiscard]] std::span<std::uint8_t> row(int r) {
    return std::span(pixels).subspan(index(left, r), static_cast<std::size_t>(width));
  }
  /// Place of a pixel in `pixels` and `levels`.
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row - top) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column - left);
  }
  [[nodiscard]] PixelWindow window() const { return {left, top, width, height}; }
  [[nodiscard]] int right() const { return left + width - 1; }  ///< Last column.
  [[nodiscard]] int bottom() const { return top + height - 1; }
  /// Grey at the picture's full depth, in units of the 8-bit scale; up to 256 - 1 / levelsPerGray().
  [[nodiscard]] double gray(int column, int row) const {
    const std::size_t i = index(column, row);
    return bits == 8 ? pixels[i] : static_cast<double>(levels[i]) / levelsPerGray();
  }
  /// Number of levels in a unit of the 8-bit scale: 1, 4 or 16.
  [[nodiscard]] int levelsPerGray() const { return 1 << (bits - 8); }

 private:
  static std::size_t areaOf(int w, int h) {
    return static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  }
};

inline GrayImage GrayImage::ofLevels(int w, int h, int depth_bits,
                                     std::vector<std::uint16_t> levels_of_pixels) {
  if (w < 0 || h < 0 || levels_of_pixels.size() != areaOf(w, h))
    throw std::invalid_argument("GrayImage: levels and size disagree");
  if (depth_bits != 10 && depth_bits != 12)
    throw std::invalid_argument("GrayImage: bits must be 8, 10 or 12");
  GrayImage image;
  image.width = w;
  image.height = h;
  image.bits = depth_bits;
  image.levels = std::move(levels_of_pixels);
  image.pixels.resize(image.levels.size());
  const unsigned shift = static_cast<unsigned>(depth_bits) - 8U;
  const unsigned half = 1U << (shift - 1U);
  unsigned all = 0;
  for (std::size_t i = 0; i < image.levels.size(); ++i) {
    const unsigned level = image.levels[i];
    all |= level;
    image.pixels[i] = static_cast<std::uint8_t>(std::min(255U, (level + half) >> shift));
  }
  if ((all >> static_cast<unsigned>(depth_bits)) != 0U)
    throw std::invalid_argument("GrayImage: a level beyond the depth");
  return image;
}

/// One exposure of a camera: the whole picture, or windows of it.
struct Frame {
  GrayImage image;                   ///< Empty if only windows were read out.
  std::uint64_t sequence{};          ///< Counts exposures, so that a dropped frame shows as a gap.
  double start_s{};                  ///< Begin of exposure on the clock of the pins.
  double exposure_s{};               ///< > 0
  std::vector<GrayImage> windows{};  ///< In the order in which they were asked for.
};

}  // namespace kerfbench

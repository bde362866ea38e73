// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hil/camera/v4l2/pixel_format.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::camera {

/// Layout of a driver's frame.
struct FrameLayout {
  const PixelFormat* format{};  ///< One of pixelFormats().
  int width_px{};               ///< > 0; even for YUYV and Bayer.
  int height_px{};              ///< > 0; even for Bayer.
  int left_px{};                ///< First column that a window of the sensor has; 0 of a whole picture.
  int top_px{};                 ///< First row; even for Bayer, as the column is.
  std::size_t stride_bytes{};   ///< Bytes from row to row; of no meaning for JPEG.
  /// Significant bits of a pixel: format->bits, or fewer for Y16 and SxxxX16, where many sensors of 10 or 12
  /// bits leave the upper ones dark; in [8, format->bits].
  int bits{8};
  bool full_range{};  ///< YUYV alone: brightness is 0 ... 255 and not 16 ... 235.

  std::size_t most_bytes{};  ///< Largest frame that the driver announces; 0: none announced.

  /// Least bytes of a whole frame; 1 for JPEG.
  [[nodiscard]] std::size_t leastBytes() const;
};

/// The frame as a grey image, a window by its columns and rows in the whole picture. Depths of 14 and 16 bits
/// become 12, those of 9 and 11 bits the next depth of GrayImage. Colour filters and JPEG go through OpenCV;
/// the weights of the colours are those of Rec. 601.
/// @throws std::invalid_argument that says why the bytes are no such frame: too few of them, a level beyond
/// its depth, a JPEG that is cut off, broken or of another size.
GrayImage decodeFrame(const FrameLayout& layout, std::span<const std::uint8_t> bytes);

}  // namespace kerfbench::camera

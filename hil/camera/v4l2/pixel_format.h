// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kerfbench::camera {

/// Kind of a frame's bytes.
enum class PixelPacking {
  kGrey8,   ///< A byte a pixel.
  kGrey16,  ///< Two bytes a pixel, the lower first; grey in the lower bits.
  kYuyv,    ///< Brightness in every other byte, colour of two pixels between.
  kJpeg,    ///< A JPEG file a frame.
};

/// Colours of the first two pixels of the first two rows of a sensor behind colour filters.
enum class BayerOrder { kNone, kBggr, kGbrg, kGrbg, kRggb };

/// One pixel format of V4L2 that becomes a grey image.
struct PixelFormat {
  std::uint32_t fourcc{};
  std::string_view name;  ///< Name as in the documentation of V4L2: GREY, Y10, SRGGB12 …
  PixelPacking packing{PixelPacking::kGrey8};
  BayerOrder bayer{BayerOrder::kNone};
  int bits{8};            ///< Significant bits of a pixel; of Y16 and SxxxX16 the most there can be.
  std::string_view cost;  ///< Cost of the format to a measurement, in words; empty: none.

  [[nodiscard]] int bytesPerPixel() const {
    return packing == PixelPacking::kGrey16 || packing == PixelPacking::kYuyv ? 2 : 1;
  }
};

/// All formats that can be read.
std::span<const PixelFormat> pixelFormats();
/// The one of this code or name; null if it cannot be read.
const PixelFormat* findPixelFormat(std::uint32_t fourcc);
const PixelFormat* findPixelFormat(std::string_view name);
/// The four letters of a code, for people.
std::string fourccText(std::uint32_t fourcc);

}  // namespace kerfbench::camera

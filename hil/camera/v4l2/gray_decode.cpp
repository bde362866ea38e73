// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/gray_decode.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "hil/camera/png.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

/// Depth of the GrayImage that takes so many bits.
int depthFor(int bits) { return bits <= 8 ? 8 : bits <= 10 ? 10 : 12; }

std::vector<std::uint16_t> readWords(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  const auto width = static_cast<std::size_t>(layout.width_px);
  const auto height = static_cast<std::size_t>(layout.height_px);
  std::vector<std::uint16_t> words;
  words.reserve(width * height);
  unsigned all = 0;
  for (std::size_t r = 0; r < height; ++r) {
    const auto row = bytes.subspan(r * layout.stride_bytes, 2 * width);
    for (std::size_t c = 0; c < width; ++c) {
      const unsigned word = row[2 * c] | static_cast<unsigned>(row[2 * c + 1]) << 8U;
      all |= word;
      words.push_back(static_cast<std::uint16_t>(word));
    }
  }
  if (all >> static_cast<unsigned>(layout.bits) != 0U)
    throw std::invalid_argument(
        fmt::format("a level beyond {} bits: the frame is broken, or packed otherwise than {} says",
                    layout.bits, layout.format->name));
  return words;
}

GrayImage imageOfWords(const FrameLayout& layout, std::vector<std::uint16_t> words) {
  const int depth = depthFor(layout.bits);
  const int down = layout.bits - depth;
  for (std::uint16_t& word : words)
    word = static_cast<std::uint16_t>(down >= 0 ? word >> down : word << -down);
  if (depth != 8) return GrayImage::ofLevels(layout.width_px, layout.height_px, depth, std::move(words));
  GrayImage image(layout.width_px, layout.height_px);
  std::ranges::transform(words, image.pixels.begin(),
                         [](std::uint16_t word) { return static_cast<std::uint8_t>(word); });
  return image;
}

GrayImage readBytes(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  GrayImage image(layout.width_px, layout.height_px);
  for (int r = 0; r < layout.height_px; ++r) {
    const auto row = bytes.subspan(static_cast<std::size_t>(r) * layout.stride_bytes,
                                   static_cast<std::size_t>(layout.width_px));
    std::ranges::copy(row, image.row(r).begin());
  }
  return image;
}

GrayImage readYuyv(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  constexpr int kBlack = 16;
  constexpr int kSpan = 219;  // Rec. 601: white is 235.
  std::array<std::uint8_t, 256> gray{};
  for (int y = 0; y < 256; ++y) {
    const int wide = (255 * (y - kBlack) + kSpan / 2) / kSpan;
    gray.at(static_cast<std::size_t>(y)) =
        static_cast<std::uint8_t>(layout.full_range ? y : std::clamp(wide, 0, 255));
  }
  GrayImage image(layout.width_px, layout.height_px);
  for (int r = 0; r < layout.height_px; ++r) {
    const auto row = bytes.subspan(static_cast<std::size_t>(r) * layout.stride_bytes);
    for (int c = 0; c < layout.width_px; ++c) image.at(c, r) = gray.at(row[2 * static_cast<std::size_t>(c)]);
  }
  return image;
}

int conversionOf(BayerOrder order) {
  switch (order) {
    case BayerOrder::kBggr:
      return cv::COLOR_BayerBGGR2GRAY;
    case BayerOrder::kGbrg:
      return cv::COLOR_BayerGBRG2GRAY;
    case BayerOrder::kGrbg:
      return cv::COLOR_BayerGRBG2GRAY;
    default:
      return cv::COLOR_BayerRGGB2GRAY;
  }
}

template <typename Pixel>
void convertColours(const FrameLayout& layout, std::vector<Pixel>& pixels) {
  cv::Mat gray;
  cv::cvtColor(cv::Mat(layout.height_px, layout.width_px, cv::DataType<Pixel>::type, pixels.data()), gray,
               conversionOf(layout.format->bayer));
  std::copy_n(gray.ptr<Pixel>(), pixels.size(), pixels.begin());
}

GrayImage readJpeg(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && bytes.back() == 0) bytes = bytes.first(bytes.size() - 1);  // Padding of the link.
  const std::size_t n = bytes.size();
  // libjpeg takes a JPEG that is cut off and makes the rest grey.
  if (n < 4 || bytes[0] != 0xff || bytes[1] != 0xd8) throw std::invalid_argument("no JPEG begins the frame");
  if (bytes[n - 2] != 0xff || bytes[n - 1] != 0xd9) throw std::invalid_argument("the JPEG is cut off");
  GrayImage image;
  try {
    image = decodeImage(bytes);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument("the JPEG cannot be read");
  }
  if (image.width != layout.width_px || image.height != layout.height_px)
    throw std::invalid_argument(fmt::format("the JPEG is {} x {} and not {} x {}", image.width, image.height,
                                            layout.width_px, layout.height_px));
  return image;
}

GrayImage decodePixels(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  if (bytes.size() < layout.leastBytes())
    throw std::invalid_argument(
        fmt::format("{} bytes where a frame has {}", bytes.size(), layout.leastBytes()));
  const bool coloured = layout.format->bayer != BayerOrder::kNone;
  switch (layout.format->packing) {
    case PixelPacking::kGrey16: {
      std::vector<std::uint16_t> words = readWords(layout, bytes);
      if (coloured) convertColours(layout, words);
      return imageOfWords(layout, std::move(words));
    }
    case PixelPacking::kYuyv:
      return readYuyv(layout, bytes);
    case PixelPacking::kJpeg:
      return readJpeg(layout, bytes);
    default: {
      GrayImage image = readBytes(layout, bytes);
      if (coloured) convertColours(layout, image.pixels);
      return image;
    }
  }
}

}  // namespace

std::size_t FrameLayout::leastBytes() const {
  if (format->packing == PixelPacking::kJpeg) return 1;
  return stride_bytes * static_cast<std::size_t>(height_px - 1) +
         static_cast<std::size_t>(width_px * format->bytesPerPixel());
}

GrayImage decodeFrame(const FrameLayout& layout, std::span<const std::uint8_t> bytes) {
  GrayImage image = decodePixels(layout, bytes);
  image.left = layout.left_px;
  image.top = layout.top_px;
  return image;
}

}  // namespace kerfbench::camera

// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>

namespace kerfbench::camera {
namespace {

using Bayer = BayerOrder;
using enum PixelPacking;

constexpr std::string_view kBayerCost =
    "grey is interpolated between pixels of different colours: less sharp, and of a coloured light (a back "
    "light, a glowing spot) only a part of the pixels see much";
constexpr std::string_view kYuyvCost =
    "grey went through the camera's gamma, sharpening and clipping to 16 ... 235: edges at half of the grey "
    "are not at half of the light";
constexpr std::string_view kJpegCost =
    "lossy: blocks of 8 by 8 pixels share errors that depend on the picture; gamma and sharpening as with "
    "YUYV. To look at, not to measure 5 um by";

constexpr std::array kFormats{
    PixelFormat{V4L2_PIX_FMT_GREY, "GREY", kGrey8, Bayer::kNone, 8, {}},
    PixelFormat{V4L2_PIX_FMT_Y10, "Y10", kGrey16, Bayer::kNone, 10, {}},
    PixelFormat{V4L2_PIX_FMT_Y12, "Y12", kGrey16, Bayer::kNone, 12, {}},
    PixelFormat{V4L2_PIX_FMT_Y16, "Y16", kGrey16, Bayer::kNone, 16, {}},
    PixelFormat{V4L2_PIX_FMT_SBGGR8, "SBGGR8", kGrey8, Bayer::kBggr, 8, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGBRG8, "SGBRG8", kGrey8, Bayer::kGbrg, 8, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGRBG8, "SGRBG8", kGrey8, Bayer::kGrbg, 8, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SRGGB8, "SRGGB8", kGrey8, Bayer::kRggb, 8, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SBGGR10, "SBGGR10", kGrey16, Bayer::kBggr, 10, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGBRG10, "SGBRG10", kGrey16, Bayer::kGbrg, 10, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGRBG10, "SGRBG10", kGrey16, Bayer::kGrbg, 10, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SRGGB10, "SRGGB10", kGrey16, Bayer::kRggb, 10, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SBGGR12, "SBGGR12", kGrey16, Bayer::kBggr, 12, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGBRG12, "SGBRG12", kGrey16, Bayer::kGbrg, 12, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGRBG12, "SGRBG12", kGrey16, Bayer::kGrbg, 12, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SRGGB12, "SRGGB12", kGrey16, Bayer::kRggb, 12, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SBGGR16, "SBGGR16", kGrey16, Bayer::kBggr, 16, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGBRG16, "SGBRG16", kGrey16, Bayer::kGbrg, 16, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SGRBG16, "SGRBG16", kGrey16, Bayer::kGrbg, 16, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_SRGGB16, "SRGGB16", kGrey16, Bayer::kRggb, 16, kBayerCost},
    PixelFormat{V4L2_PIX_FMT_YUYV, "YUYV", kYuyv, Bayer::kNone, 8, kYuyvCost},
    PixelFormat{V4L2_PIX_FMT_MJPEG, "MJPEG", kJpeg, Bayer::kNone, 8, kJpegCost},
};

}  // namespace

std::span<const PixelFormat> pixelFormats() { return kFormats; }

const PixelFormat* findPixelFormat(std::uint32_t fourcc) {
  const auto* const found = std::ranges::find(kFormats, fourcc, &PixelFormat::fourcc);
  return found == kFormats.end() ? nullptr : &*found;
}

const PixelFormat* findPixelFormat(std::string_view name) {
  const auto* const found = std::ranges::find(kFormats, name, &PixelFormat::name);
  return found == kFormats.end() ? nullptr : &*found;
}

std::string fourccText(std::uint32_t fourcc) {
  std::string text;
  for (const unsigned shift : {0U, 8U, 16U, 24U}) {
    const auto c = static_cast<char>(fourcc >> shift & 0x7fU);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  while (text.size() > 1 && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace kerfbench::camera

// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/png.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "hil/base/png_codec.h"
#include "hil/camera/jpeg.h"
#include "twin/base/image.h"

namespace kerfbench::camera {
namespace {

// A PNG is a signature, then chunks: length, name, data, checksum of name and data. IHDR comes first.
constexpr std::size_t kSignature = 8;
constexpr std::size_t kChunkFrame = 12;
constexpr std::size_t kHeaderEnd = kSignature + kChunkFrame + 13;
constexpr std::string_view kSignificantBits = "sBIT";

std::uint32_t crcOf(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0xedb88320U : 0U);
  }
  return crc ^ 0xffffffffU;
}

void appendBigEndian(std::vector<std::uint8_t>& to, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) to.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::vector<std::uint8_t> significantBitsChunk(int bits) {
  std::vector<std::uint8_t> chunk;
  appendBigEndian(chunk, 1);
  chunk.insert(chunk.end(), kSignificantBits.begin(), kSignificantBits.end());
  chunk.push_back(static_cast<std::uint8_t>(bits));
  appendBigEndian(chunk, crcOf(std::span(chunk).subspan(4)));
  return chunk;
}

/// Depth of the first channel by sBIT; 16 if there is none.
int significantBits(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = kSignature; at + kChunkFrame < bytes.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8U | bytes[at + i];
    if (std::equal(kSignificantBits.begin(), kSignificantBits.end(),
                   bytes.begin() + static_cast<long>(at) + 4))
      return length > 0 ? bytes[at + 8] : 16;
    at += kChunkFrame + length;
  }
  return 16;
}

/// The samples of 16 bits as an image of 10 or 12.
GrayImage deepImage(const base::PngSamples& picture, int bits) {
  const int depth = bits <= 10 ? 10 : 12;
  std::vector<std::uint16_t> levels(picture.bytes.size() / 2);
  std::memcpy(levels.data(), picture.bytes.data(), picture.bytes.size());
  for (std::uint16_t& level : levels) level = static_cast<std::uint16_t>(level >> (16 - depth));
  return GrayImage::ofLevels(picture.width_px, picture.height_px, depth, std::move(levels));
}

}  // namespace

std::vector<std::uint8_t> encodePng(const GrayImage& image) {
  const auto area = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width <= 0 || image.height <= 0 || image.pixels.size() != area ||
      image.levels.size() != (image.bits == 8 ? 0 : area)) {
    throw std::invalid_argument("encodePng: an image without pixels");
  }
  if (image.bits == 8)
    return base::encodePng({image.width, image.height, 1, 8, image.pixels}, base::PngEffort::kQuick);
  std::vector<std::uint16_t> scaled;
  scaled.reserve(area);
  for (const std::uint16_t level : image.levels) {
    scaled.push_back(static_cast<std::uint16_t>(level << (16 - image.bits) | level >> (2 * image.bits - 16)));
  }
  const std::span samples(reinterpret_cast<const std::uint8_t*>(scaled.data()), 2 * scaled.size());
  std::vector<std::uint8_t> bytes =
      base::encodePng({image.width, image.height, 1, 16, samples}, base::PngEffort::kQuick);
  const std::vector<std::uint8_t> chunk = significantBitsChunk(image.bits);
  bytes.insert(bytes.begin() + kHeaderEnd, chunk.begin(), chunk.end());
  return bytes;
}

GrayImage decodeImage(std::span<const std::uint8_t> bytes) {
  if (std::optional<GrayImage> image = decodeJpeg(bytes)) return std::move(*image);
  const std::optional<base::PngSamples> picture = base::decodePng(bytes, base::PngColours::kGrey);
  if (!picture) throw std::invalid_argument("decodeImage: not a picture that can be read");
  if (picture->bits == 16) return deepImage(*picture, significantBits(bytes));
  GrayImage image(picture->width_px, picture->height_px);
  std::ranges::copy(picture->bytes, image.pixels.begin());
  return image;
}

}  // namespace kerfbench::camera

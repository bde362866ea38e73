// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kerfbench::base {

/// Samples of a picture as they lie in a PNG: row by row from the top left, channel by channel, 16 bits in
/// the machine's own byte order.
struct PngSamples {
  int width_px{};   ///< > 0.
  int height_px{};  ///< > 0.
  int channels{1};  ///< 1: grey; 3: red, green, blue.
  int bits{8};      ///< 8 or 16.
  std::vector<std::uint8_t> bytes;
};

/// PNG picture whose bytes belong to somebody else.
struct PngView {
  int width_px{};
  int height_px{};
  int channels{1};
  int bits{8};
  std::span<const std::uint8_t> bytes;
};

enum class PngEffort {
  kQuick,  ///< Each row less its left neighbours, runs alone: for folders of many tiles.
  kSmall,  ///< The best filter for each row, zlib's level 6: for what a report or a guide shows.
};

enum class PngColours {
  kGrey,  ///< Colour becomes 0.299 red + 0.587 green + 0.114 blue (Rec. 601); 16 bits stay 16 bits.
  kRgb,   ///< Grey becomes three equal channels; 16 bits become their upper 8.
};

/// The file's bytes. The same picture gives the same bytes.
/// @throws std::invalid_argument if sizes, channels, bits and bytes disagree.
std::vector<std::uint8_t> encodePng(const PngView& picture, PngEffort effort);

/// The picture in a PNG of any kind (palette, 1 … 16 bits, interlaced). Transparency is left out. nullopt
/// where the bytes are no whole, undamaged PNG, or have 2^30 pixels and more.
std::optional<PngSamples> decodePng(std::span<const std::uint8_t> bytes, PngColours colours);

}  // namespace kerfbench::base

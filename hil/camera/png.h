// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "twin/base/image_fwd.h"

namespace kerfbench::camera {

/// The image as the bytes of a PNG file; the caller writes them whole or not at all. Pictures of 10 and 12
/// bits become PNGs of 16 bits, scaled to the whole range as the PNG specification asks for (the upper bits
/// are repeated below), with their true depth in the sBIT chunk.
/// @throws std::invalid_argument for an empty image or one whose size and pixels disagree.
std::vector<std::uint8_t> encodePng(const GrayImage& image);

/// The grey image in the bytes of a PNG or a JPEG; colour becomes grey. A picture of 16 bits has the depth
/// that its sBIT says, 12 bits if it says none or more, 10 if it says fewer. Pixels stay where the file has
/// them: a note in it on how to turn the picture for looking at is left out.
/// @throws std::invalid_argument if it cannot be read.
GrayImage decodeImage(std::span<const std::uint8_t> bytes);

}  // namespace kerfbench::camera

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "twin/base/image.h"

namespace kerfbench::hil {

/// The image as the bytes of a PNG file; the caller writes them whole or not at all.
/// @throws std::invalid_argument for an empty image or one whose size and pixels disagree.
std::vector<std::uint8_t> encodePng(const GrayImage& image);

/// The grey image in the bytes of a PNG (or any other picture file that OpenCV reads); colour becomes grey.
/// @throws std::invalid_argument if it cannot be read.
GrayImage decodeImage(std::span<const std::uint8_t> bytes);

}  // namespace kerfbench::hil

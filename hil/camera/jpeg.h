// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "twin/base/image_fwd.h"

namespace kerfbench::camera {

/// The brightness in the bytes of a JPEG, 8 bits; its colours are left out. A frame of Motion JPEG without
/// tables of its own has the standard's. nullopt where the bytes are no JPEG, or have 2^30 pixels and more;
/// of a JPEG that ends too early the rest is grey.
std::optional<GrayImage> decodeJpeg(std::span<const std::uint8_t> bytes);

}  // namespace kerfbench::camera

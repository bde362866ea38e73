// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/scene/picture.h"

namespace kerfbench::scene {

/// Whether a picture has the head in a corner.
bool hasInset(const twin::Scene& scene, const PictureOptions& options);

/// As renderPng(), from a viewpoint of the picture's size: that of renderPng() is chosen for each scene anew,
/// and in a film the room would shake.
std::vector<std::uint8_t> renderPngFrom(const twin::Scene& scene, const PictureOptions& options,
                                        const Viewpoint& view);

}  // namespace kerfbench::scene

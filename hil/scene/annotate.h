// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/png_codec.h"
#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A small picture in the upper right corner of the large one.
struct Inset {
  base::PngSamples picture;  ///< Red, green, blue, 8 bits.
  Viewpoint view;            ///< Viewpoint of the small picture, for its labels.
  std::vector<twin::SceneLabel> labels;
};

/// Writes labels and caption on a picture (red, green, blue, 8 bits), sets the inset in, and encodes the
/// whole as a PNG file's bytes.
std::vector<std::uint8_t> annotate(base::PngSamples samples, const std::vector<twin::SceneLabel>& labels,
                                   const Viewpoint& view, const std::string& caption,
                                   std::optional<Inset> inset);

}  // namespace kerfbench::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A small picture in the upper right corner of the large one.
struct Inset {
  std::vector<std::uint8_t> png;  ///< Empty: none.
  std::optional<Viewpoint> view;  ///< Viewpoint of the small picture, for its labels.
  std::vector<twin::SceneLabel> labels;
};

/// Writes labels and caption on a picture, sets the inset in, and encodes the whole again: nothing of the
/// file that the ray tracer wrote (its comments and times) is left but the pixels.
/// @throws PictureError if a picture cannot be read.
std::vector<std::uint8_t> annotate(const std::vector<std::uint8_t>& png,
                                   const std::vector<twin::SceneLabel>& labels, const Viewpoint& view,
                                   const std::string& caption, const Inset& inset);

}  // namespace kerfbench::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// Lamps around a scene, as a viewpoint has them: a large soft key lamp over the reader's left shoulder, fill
/// from the right and from above, and a bright panel that only mirrors see, so that metal has something to
/// reflect. In W.
struct Lighting {
  Eigen::Vector3d key_mm;
  Eigen::Vector3d key_along_mm, key_across_mm;  ///< Edges of the square that the key lamp's disc fills.
  Eigen::Vector3d fill_mm, top_mm;
  Eigen::Vector3d panel_mm;  ///< Middle of the panel, which lies flat.
  double panel_half_mm{};    ///< Half of the panel's edge.
  double fog_mm{};           ///< Distance at which the background hides 1 - 1/e.
};

Lighting lightingOf(const twin::Scene& scene, const Viewpoint& view);

}  // namespace kerfbench::scene

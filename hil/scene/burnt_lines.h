// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/scene/view.h"
#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A burnt path as a picture needs it.
struct BurntLine {
  std::vector<Eigen::Vector3d> points_W_mm;  ///< At least two.
  double radius_mm{};  ///< Half of its width: that of a usual kerf, but at least what the picture resolves.
};

/// Burnt paths of a scene without the points that the viewpoint cannot tell from a straight line, and without
/// paths that lie behind it.
std::vector<BurntLine> burntLines(const twin::Scene& scene, const Viewpoint& view);

}  // namespace kerfbench::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "twin/camera/plane_grid.h"
#include "twin/camera/projection.h"
#include "twin/camera/spot_scene.h"

namespace kerfbench::twin {

/// Draws a printed disc at its places during an exposure, with a blurred edge. Private to this room.
class DiscPainter {
 public:
  /// `patch`: where the pixels of the disc's box lie on the plane. `darkening_gray`: gray of ink less gray of
  /// board. Both must outlive this.
  DiscPainter(const MarkImage& mark, const PlanePatch& patch, double blur_px, double darkening_gray);

  /// Adds what of the disc lies in a box to its light, row by row.
  void add(const PixelBox& box, std::vector<float>& light) const;

 private:
  const MarkImage& mark_;
  const PlanePatch& patch_;
  Eigen::Vector2d middle_mm_;
  double blur_mm_;
  double darkening_gray_;
};

}  // namespace kerfbench::twin

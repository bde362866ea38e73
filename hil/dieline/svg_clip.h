// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// A convex area outside of which nothing is drawn, in mm in S.
struct ClipRegion {
  std::vector<Eigen::Vector2d> corners_mm;  ///< Counter-clockwise; empty: an area that is not convex.
  std::string name;                         ///< For people: "clip-path 'url(#a)'".
};

enum class Clipped { kNot, kWholly, kPartly };

/// What a region leaves of a curve; a micrometre beyond its edge counts as inside.
Clipped clippedBy(const ClipRegion& region, const Curve& curve);

/// The region of a closed outline of straight lines, given by its curves in order; nothing where it is no
/// convex polygon.
std::optional<std::vector<Eigen::Vector2d>> convexPolygon(const std::vector<Curve>& curves,
                                                          const Eigen::Affine2d& X);

}  // namespace kerfbench::dieline

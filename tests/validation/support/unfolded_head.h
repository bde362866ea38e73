// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "twin/optics/optics_description.h"

namespace kerfbench::validation {

/// Spot of a two-mirror head without a ray trace: each mirror is an affine map that reflects space, the
/// laser's line is seen twice reflected, and that line meets the plane z = height + slope · p, or the lens.
Eigen::Vector2d unfoldedSpot_mm(const twin::ScanHeadDescription& head, const twin::BeamDescription& beam,
                                const twin::SurfaceDescription& plane, const Eigen::Vector2d& mirror_rad);

}  // namespace kerfbench::validation

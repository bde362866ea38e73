// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Two arcs with a common tangent, from p0 along the unit tangent t0 to p1, where the unit tangent is t1;
/// with equal tangent lengths d: |p1 - p0 - d (t0 + t1)| = 2 d (Bolton 1975). An arc whose sagitta is less
/// than flat_mm is a line.
std::array<Segment, 2> biarc(const Eigen::Vector2d& p0, const Eigen::Vector2d& t0, const Eigen::Vector2d& p1,
                             const Eigen::Vector2d& t1, double flat_mm);

}  // namespace kerfbench::planner

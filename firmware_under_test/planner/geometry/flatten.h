// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// Flattens a curve into lines and arcs that follow it within tolerance_mm: lines and circular arcs
/// unchanged, ellipses and Béziers as biarcs (two arcs with a common tangent, and the curve's own tangents at
/// the ends), so joints stay smooth.
std::vector<Segment> flatten(const dieline::Curve& curve, double tolerance_mm);

}  // namespace kerfbench::planner

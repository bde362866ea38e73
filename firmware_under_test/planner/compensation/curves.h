// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Distance below which curves touch.
inline constexpr double kTouchMm = 1e-7;

/// Distance of p from the nearest point of a line or an arc (whose two radii are equal).
double distanceMm(const Segment& segment, const Eigen::Vector2d& p_mm);

/// Arc length of the point of the segment that lies nearest to p, which is on it or next to it.
double stationMm(const Segment& segment, const Eigen::Vector2d& p_mm);

/// Points where two segments cross or touch, and where a stretch that they share begins and ends. A point may
/// be named twice.
std::vector<Eigen::Vector2d> meetings(const Segment& a, const Segment& b);

Eigen::AlignedBox2d boxOf(const Segment& segment);

/// Area enclosed by a closed path, > 0 if it runs counter-clockwise.
double signedAreaMm2(const std::vector<Segment>& path);

}  // namespace kerfbench::planner

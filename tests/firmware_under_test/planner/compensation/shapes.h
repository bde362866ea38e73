// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <vector>

#include "firmware_under_test/planner/compensation/contour.h"

namespace kerfbench::planner::test {

Segment line(double x0, double y0, double x1, double y1, int entity = 0);
/// Arc through its ends with the given sweep, > 0 counter-clockwise.
Segment arc(double x0, double y0, double x1, double y1, double sweep_rad, int entity = 0);
Segment circle(double x, double y, double radius, int entity = 0);

/// Corners joined by lines and back to the first; entities count from `entity`.
std::vector<Segment> polygon(const std::vector<Eigen::Vector2d>& corners, int entity = 0);

/// A random closed contour that does not cross itself: corners at growing angles round a centre, sides lines
/// or arcs that bulge by up to `bulge_rad`.
Contour star(std::mt19937& random, int corners, double inner_mm, double outer_mm, double bulge_rad,
             const Eigen::Vector2d& centre = Eigen::Vector2d::Zero());

}  // namespace kerfbench::planner::test

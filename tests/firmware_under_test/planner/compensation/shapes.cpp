// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <cmath>
#include <numbers>

namespace kerfbench::planner::test {

using Eigen::Vector2d;

Segment line(double x0, double y0, double x1, double y1, int entity) {
  Segment s;
  s.start_mm = {x0, y0};
  s.end_mm = {x1, y1};
  s.entity = entity;
  s.z = 1.0;
  return s;
}

Segment arc(double x0, double y0, double x1, double y1, double sweep_rad, int entity) {
  Segment s = line(x0, y0, x1, y1, entity);
  const Vector2d chord = s.end_mm - s.start_mm;
  s.sweep_rad = sweep_rad;
  s.centre_mm = s.start_mm + 0.5 * chord + 0.5 / std::tan(0.5 * sweep_rad) * Vector2d(-chord.y(), chord.x());
  return s;
}

Segment circle(double x, double y, double radius, int entity) {
  Segment s = line(x + radius, y, x + radius, y, entity);
  s.centre_mm = {x, y};
  s.sweep_rad = 2.0 * std::numbers::pi;
  return s;
}

std::vector<Segment> polygon(const std::vector<Vector2d>& corners, int entity) {
  std::vector<Segment> sides;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[(i + 1) % corners.size()];
    sides.push_back(line(a.x(), a.y(), b.x(), b.y(), entity + static_cast<int>(i)));
  }
  return sides;
}

Contour star(std::mt19937& random, int corners, double inner_mm, double outer_mm, double bulge_rad,
             const Vector2d& centre) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  std::vector<Vector2d> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + uniform(0.0, 0.7)) / corners;
    points.emplace_back(centre + uniform(inner_mm, outer_mm) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  Contour contour;
  contour.closed = true;
  contour.segments = polygon(points);
  for (Segment& side : contour.segments) {
    if (random() % 2 == 0) continue;
    const double sweep = uniform(-bulge_rad, bulge_rad);
    side = arc(side.start_mm.x(), side.start_mm.y(), side.end_mm.x(), side.end_mm.y(), sweep, side.entity);
  }
  return contour;
}

}  // namespace kerfbench::planner::test

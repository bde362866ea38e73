// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/power/curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerfbench::planner {
namespace {

/// Linear interpolation, exact at both ends.
double between(double share, double from, double to) { return (1.0 - share) * from + share * to; }

}  // namespace

Curve::Curve(std::vector<Point> points) : points_(std::move(points)) {
  if (points_.size() < 2) throw PowerError("a curve needs two points or more");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!std::isfinite(points_[i].x) || !std::isfinite(points_[i].y))
      throw PowerError("a curve needs finite numbers");
    if (i > 0 && !(points_[i].x > points_[i - 1].x && points_[i].y > points_[i - 1].y))
      throw PowerError("a curve must rise from point to point");
  }
}

double Curve::at(double x) const {
  if (!(x > points_.front().x)) return points_.front().y;
  if (x >= points_.back().x) return points_.back().y;
  const auto next = std::upper_bound(points_.begin(), points_.end(), x,
                                     [](double value, const Point& point) { return value < point.x; });
  const Point& before = *std::prev(next);
  return between((x - before.x) / (next->x - before.x), before.y, next->y);
}

std::optional<double> Curve::inverse(double y) const {
  if (!(y >= points_.front().y && y <= points_.back().y)) return std::nullopt;
  if (y == points_.back().y) return points_.back().x;
  const auto next = std::upper_bound(points_.begin(), points_.end(), y,
                                     [](double value, const Point& point) { return value < point.y; });
  const Point& before = *std::prev(next);
  return between((y - before.y) / (next->y - before.y), before.x, next->x);
}

}  // namespace kerfbench::planner

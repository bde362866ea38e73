// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/geometry/segment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::planner {

bool Segment::isCircle() const { return std::abs(sweep_rad) > 2.0 * std::numbers::pi - 1e-9; }

double Segment::radiusMm() const {
  return 0.5 * ((start_mm - centre_mm).norm() + (end_mm - centre_mm).norm());
}

double Segment::lengthMm() const {
  return isArc() ? radiusMm() * std::abs(sweep_rad) : (end_mm - start_mm).norm();
}

Eigen::Vector2d Segment::at(double s_mm) const {
  const double length = lengthMm();
  const double u = length > 0.0 ? std::clamp(s_mm / length, 0.0, 1.0) : 1.0;
  if (!isArc()) return start_mm + u * (end_mm - start_mm);
  const Eigen::Vector2d from = start_mm - centre_mm;
  const double first_mm = from.norm();
  const double radius_mm = first_mm + u * ((end_mm - centre_mm).norm() - first_mm);
  const double angle = std::atan2(from.y(), from.x()) + u * sweep_rad;
  return centre_mm + radius_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

Eigen::Vector2d Segment::tangentAt(double s_mm) const {
  if (!isArc()) {
    const Eigen::Vector2d chord = end_mm - start_mm;
    const double length = chord.norm();
    return length > 0.0 ? Eigen::Vector2d(chord / length) : Eigen::Vector2d::UnitX();
  }
  const Eigen::Vector2d radial = (at(s_mm) - centre_mm).normalized();
  const double sense = sweep_rad > 0.0 ? 1.0 : -1.0;
  return sense * Eigen::Vector2d(-radial.y(), radial.x());
}

Segment Segment::reversed() const {
  Segment back = *this;
  std::swap(back.start_mm, back.end_mm);
  back.sweep_rad = -sweep_rad;
  return back;
}

Segment Segment::part(double from_mm, double to_mm) const {
  Segment piece = *this;
  piece.start_mm = at(from_mm);
  piece.end_mm = at(to_mm);
  if (isArc()) piece.sweep_rad = sweep_rad * (to_mm - from_mm) / lengthMm();
  return piece;
}

double turnRad(const Segment& a, const Segment& b) {
  const Eigen::Vector2d in = a.tangentAt(a.lengthMm());
  const Eigen::Vector2d out = b.tangentAt(0.0);
  return std::abs(std::atan2(cross(in, out), in.dot(out)));
}

std::vector<Segment> reversedPath(const std::vector<Segment>& path) {
  std::vector<Segment> back;
  back.reserve(path.size());
  for (auto it = path.rbegin(); it != path.rend(); ++it) back.push_back(it->reversed());
  return back;
}

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/drawing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace kerfbench::diagnose {
namespace {

constexpr double kStation_mm = 0.5;

}  // namespace

Polyline::Polyline(const dieline::Curve& curve) {
  const bool is_straight = std::holds_alternative<dieline::LineCurve>(curve);
  std::optional<Eigen::Vector2d> before;
  for (const double u : is_straight ? std::vector{0.0, 1.0} : dieline::stations(curve, kStation_mm)) {
    const Eigen::Vector2d p = dieline::pointAt(curve, u);
    box_.extend(p);
    if (before) lines_.push_back({*before, p - *before});
    before = p;
  }
}

void Polyline::shorten(const Eigen::Vector2d& p_mm, Eigen::Vector2d& away) const {
  double least = away.squaredNorm();
  if (box_.squaredExteriorDistance(p_mm) >= least) return;
  for (const Line& line : lines_) {
    const Eigen::Vector2d from_start = p_mm - line.start;
    const double length2 = line.along.squaredNorm();
    const double u = length2 > 0.0 ? std::clamp(from_start.dot(line.along) / length2, 0.0, 1.0) : 0.0;
    const Eigen::Vector2d rest = from_start - u * line.along;
    if (rest.squaredNorm() >= least) continue;
    least = rest.squaredNorm();
    away = rest;
  }
}

Drawing::Drawing(const dieline::Dieline& dieline, const PrintLayout& print) : print_(print) {
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kIgnore) continue;
    curves_.emplace_back(entity.curve);
    box_.extend(curves_.back().box());
  }
}

Eigen::Vector2d Drawing::inUnit(Eigen::Vector2d p_mm) const {
  if (!(print_.pitch_mm > 0.0)) return p_mm;
  const double unit = std::round((box_.center().x() - p_mm.x()) / print_.pitch_mm);
  p_mm.x() += std::clamp(unit, 0.0, static_cast<double>(print_.units - 1)) * print_.pitch_mm;
  return p_mm;
}

Eigen::Vector2d Drawing::awayFrom(const Eigen::Vector2d& p_mm) const {
  constexpr double kFar_mm = 1e6;
  Eigen::Vector2d away = Eigen::Vector2d::Constant(kFar_mm);
  for (const Polyline& curve : curves_) curve.shorten(p_mm, away);
  return away;
}

}  // namespace kerfbench::diagnose

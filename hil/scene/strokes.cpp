// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/strokes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "hil/scene/burnt_lines.h"

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double depth_mm(const Viewpoint& view, const Vector3d& p_W_mm) {
  return (p_W_mm - view.place_mm()).dot(view.forward());
}

/// Both ends with a radius each, mm; what lies behind the eye is cut off.
std::optional<Stroke> strokeBetween(const Viewpoint& view, twin::BeamPoint a, twin::BeamPoint b,
                                    double least_px) {
  constexpr double kNearest_mm = 1.0;
  for (int turn = 0; turn < 2; ++turn, std::swap(a, b)) {
    const double depth_a = depth_mm(view, a.p_W_mm);
    const double depth_b = depth_mm(view, b.p_W_mm);
    if (std::max(depth_a, depth_b) < kNearest_mm) return std::nullopt;
    if (depth_a < kNearest_mm)
      a.p_W_mm += (kNearest_mm - depth_a) / (depth_b - depth_a) * 1.0000001 * (b.p_W_mm - a.p_W_mm);
  }
  const auto from = view.project(a.p_W_mm);
  const auto to = view.project(b.p_W_mm);
  if (!from || !to || !from->allFinite() || !to->allFinite()) return std::nullopt;
  Stroke stroke;
  stroke.from_px = *from;
  stroke.to_px = *to;
  stroke.half_px = {std::max(least_px, a.radius_mm / view.pixel_mm(a.p_W_mm)),
                    std::max(least_px, b.radius_mm / view.pixel_mm(b.p_W_mm))};
  stroke.nearness = {1.0 / depth_mm(view, a.p_W_mm), 1.0 / depth_mm(view, b.p_W_mm)};
  // Half of its width, as a length at its own depth.
  stroke.relief = stroke.half_px.maxCoeff() * 2.0 * view.half_width_tan() / view.width_px();
  return stroke;
}

void addStroke(std::vector<Stroke>& strokes, std::optional<Stroke> stroke, Stroke::Kind kind) {
  if (!stroke) return;
  stroke->kind = kind;
  strokes.push_back(*stroke);
}

void addShell(std::vector<Stroke>& strokes, const twin::Scene& scene, const Viewpoint& view, double of_radius,
              double least_px, Stroke::Kind kind) {
  for (std::size_t i = 0; i + 1 < scene.beam.size(); ++i) {
    twin::BeamPoint a = scene.beam[i];
    twin::BeamPoint b = scene.beam[i + 1];
    a.radius_mm *= of_radius;
    b.radius_mm *= of_radius;
    addStroke(strokes, strokeBetween(view, a, b, least_px), kind);
  }
}

// Straight between the points (x, y) of a curve, of which the last is met by all that is beyond.
template <std::size_t N>
double along(const Vector2d (&curve)[N], double x) {
  if (x <= curve[0].x()) return curve[0].y();
  for (std::size_t i = 1; i < N; ++i) {
    if (x > curve[i].x()) continue;
    const double share = (x - curve[i - 1].x()) / (curve[i].x() - curve[i - 1].x());
    return curve[i - 1].y() + share * (curve[i].y() - curve[i - 1].y());
  }
  return curve[N - 1].y();
}

// Cover at a share of the half width off the middle, as of a shell whose material depends on the angle at
// which it is seen (pattern `aoi` of pov_materials.cpp): 1 for straight on, 0.5 at its rim.
double shellCover(Stroke::Kind kind, double off) {
  static const Vector2d kCore[] = {{0.52, 0.0}, {0.75, 0.75}, {1.0, 1.0}};
  static const Vector2d kGlow[] = {{0.52, 0.0}, {0.80, 0.07}, {1.0, 0.38}};
  const double facing = 1.0 - std::asin(std::min(off, 1.0)) / std::numbers::pi;
  return kind == Stroke::Kind::kCore ? along(kCore, facing) : along(kGlow, facing);
}

}  // namespace

std::vector<Stroke> burntStrokes(const twin::Scene& scene, const Viewpoint& view) {
  std::vector<Stroke> strokes;
  for (const BurntLine& line : burntLines(scene, view)) {
    for (std::size_t i = 0; i + 1 < line.points_W_mm.size(); ++i) {
      std::optional<Stroke> stroke = strokeBetween(view, {line.points_W_mm[i], line.radius_mm},
                                                   {line.points_W_mm[i + 1], line.radius_mm}, 0.0);
      // A cut lies in the board's surface, which may be seen at a flat angle.
      if (stroke) stroke->relief *= 4.0;
      addStroke(strokes, stroke, Stroke::Kind::kBurnt);
    }
  }
  return strokes;
}

std::vector<Stroke> beamStrokes(const twin::Scene& scene, const Viewpoint& view) {
  std::vector<Stroke> strokes;
  if (!scene.beam_on) {
    addShell(strokes, scene, view, 0.3, 0.6, Stroke::Kind::kBeamOff);
    return strokes;
  }
  addShell(strokes, scene, view, 0.8, 1.4, Stroke::Kind::kCore);
  addShell(strokes, scene, view, 2.2, 5.0, Stroke::Kind::kGlow);
  if (scene.beam.empty()) return strokes;
  const twin::BeamPoint spot{scene.beam.back().p_W_mm, 0.0};
  addStroke(strokes, strokeBetween(view, spot, spot, 2.4), Stroke::Kind::kSpot);
  addStroke(strokes, strokeBetween(view, spot, spot, 9.0), Stroke::Kind::kGlow);
  return strokes;
}

std::optional<StrokeSample> sampleOf(const Stroke& stroke, const Vector2d& p_px) {
  const Vector2d way = stroke.to_px - stroke.from_px;
  const bool dot = !(way.squaredNorm() > 0);
  double at = dot ? 0.0 : (p_px - stroke.from_px).dot(way) / way.squaredNorm();
  const bool shell = stroke.kind == Stroke::Kind::kCore || stroke.kind == Stroke::Kind::kGlow;
  // A shell is open at its ends: rounded, it would shine twice as bright where two of them meet.
  if (shell && (at < 0 || at > 1)) return std::nullopt;
  at = std::clamp(at, 0.0, 1.0);
  const double off_px = (p_px - stroke.from_px - at * way).norm();
  const double half_px = stroke.half_px[0] + at * (stroke.half_px[1] - stroke.half_px[0]);
  if (off_px > half_px + 0.5) return std::nullopt;
  StrokeSample sample;
  sample.nearness = stroke.nearness[0] + at * (stroke.nearness[1] - stroke.nearness[0]);
  sample.cover = shell ? shellCover(stroke.kind, off_px / half_px)
                       : std::clamp(half_px + 0.5 - off_px, 0.0, std::min(1.0, 2.0 * half_px));
  if (stroke.kind == Stroke::Kind::kBeamOff) sample.cover *= 0.55;
  return sample;
}

Colour colourOf(Stroke::Kind kind) {
  switch (kind) {
    case Stroke::Kind::kBurnt:
      return {0.017, 0.007, 0.003};
    case Stroke::Kind::kBeamOff:
      return 0.8 * Colour(0.60, 0.03, 0.02);
    case Stroke::Kind::kCore:
      return 1.5 * Colour(1.0, 0.32, 0.06);
    case Stroke::Kind::kGlow:
      return 1.1 * Colour(1.0, 0.08, 0.01);
    case Stroke::Kind::kSpot:
      break;
  }
  return 1.8 * Colour(1.0, 0.50, 0.14);
}

}  // namespace kerfbench::scene

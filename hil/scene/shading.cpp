// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMap_px = 768;
constexpr double kFilled = 0.9;  // Share of the map: soft shadows look a little beyond.
const Colour kBackground(0.40, 0.42, 0.45);
const Colour kKey = 1.15 * Colour(1.0, 0.97, 0.92);
const Colour kFill = 0.30 * Colour(0.75, 0.85, 1.0);
const Colour kTop = Colour::Constant(0.14);
const Colour kSpot = 1.6 * Colour(1.0, 0.35, 0.08);
constexpr double kPanel = 1.5;

std::vector<Sides> castersOf(const Mesh& mesh) {
  std::vector<Sides> sides;
  sides.reserve(mesh.faces.size());
  for (const Face& face : mesh.faces) {
    // What lies flat on belt and board would only be taken for its own shadow.
    const bool flat = face.look == Look::kBeltHole || face.look == Look::kPrint;
    sides.push_back(flat || isClear(face.look) ? Sides::kNone : Sides::kFront);
  }
  return sides;
}

Viewpoint viewpointOfLamp(const Mesh& mesh, const std::vector<Sides>& casters, const Lighting& lighting) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : mesh.triangles) {
    if (casters[static_cast<std::size_t>(triangle.face)] == Sides::kNone) continue;
    for (const Vector3d& p : triangle.corners_W_mm) box.extend(p);
  }
  // Something to look at, where nothing casts a shadow.
  if (box.isEmpty()) box = Eigen::AlignedBox3d(Vector3d::Zero(), Vector3d::Ones());
  std::vector<Vector3d> points;
  for (int i = 0; i < 8; ++i)
    points.emplace_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  return Viewpoint::from(lighting.key_mm, points, kMap_px, kFilled);
}

// Points that fill a disc of radius 1 evenly (sunflower; Vogel 1979).
constexpr int kTaps = 32;
const std::array<Vector2d, kTaps>& taps() {
  static const std::array<Vector2d, kTaps> points = [] {
    std::array<Vector2d, kTaps> p;
    const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < kTaps; ++i) {
      const double r = std::sqrt((i + 0.5) / kTaps);
      p.at(static_cast<std::size_t>(i)) = r * Vector2d(std::cos(golden_rad * i), std::sin(golden_rad * i));
    }
    return p;
  }();
  return points;
}

}  // namespace

bool isClear(Look look) { return look == Look::kGlass || look == Look::kTube; }

Clear clearOf(Look look) {
  if (look == Look::kTube) return {0.74, 0.5 * Colour(0.75, 0.85, 0.92)};
  return {0.90, 0.35 * Colour(0.55, 0.78, 0.85)};
}

ShadowMap::ShadowMap(const Mesh& mesh, const Lighting& lighting)
    : view_(viewpointOfLamp(mesh, castersOf(mesh), lighting)),
      rows_(kMap_px, kMap_px),
      lamp_radius_mm_(0.5 * lighting.key_along_mm.norm()) {
  rows_.begin(0);
  for (const SeenTriangle& triangle : seenTriangles(mesh, view_, 1, castersOf(mesh))) rows_.draw(triangle);
}

double ShadowMap::nearnessAt(int x, int y) const {
  if (x < 0 || y < 0 || x >= kMap_px || y >= kMap_px) return 0.0;
  return static_cast<double>(rows_.nearness(rows_.at(y) + static_cast<std::size_t>(x)));
}

/// A point's plane in the map: one over the depth is linear there.
struct ShadowMap::Plane {
  Vector2d at_px;
  double nearness{};
  Vector2d slope;
  [[nodiscard]] double nearnessAt(double x, double y) const {
    return nearness + slope.x() * (x - at_px.x()) + slope.y() * (y - at_px.y());
  }
};

// Lit share of the four texels around a place, by how near it is to each.
double ShadowMap::litAt(const Plane& plane, const Vector2d& p) const {
  const int x = static_cast<int>(p.x());
  const int y = static_cast<int>(p.y());
  const Vector2d f(p.x() - x, p.y() - y);
  const auto free = [&](int dx, int dy) {
    const double near = nearnessAt(x + dx, y + dy);
    return near <= plane.nearnessAt(x + dx, y + dy) || near == 0.0 ? 1.0 : 0.0;
  };
  return (1 - f.y()) * ((1 - f.x()) * free(0, 0) + f.x() * free(1, 0)) +
         f.y() * ((1 - f.x()) * free(0, 1) + f.x() * free(1, 1));
}

// Shadows that are softer the farther their caster is (percentage-closer soft shadows; Fernando 2005). Each
// texel is compared with the plane of the face there, so that a face is not taken for its own caster.
double ShadowMap::lit(const Vector3d& p_W_mm, const Vector3d& normal) const {
  const double texel_mm = view_.pixel_mm(p_W_mm);
  const Vector3d lifted = p_W_mm + texel_mm * normal;
  const Vector3d way = lifted - view_.place_mm();
  const auto p = view_.project(lifted);
  constexpr double kReach_px = 30.0;
  if (!p || (p->array() < kReach_px).any() || (p->array() > kMap_px - 1 - kReach_px).any()) return 1.0;
  const double scale = 2.0 * view_.half_width_tan() / kMap_px;
  const double off = normal.dot(way);
  if (!(off < 0)) return 1.0;  // The face looks away, and the lamp does not light it anyway.
  const Plane plane{*p, 1.0 / way.dot(view_.forward()),
                    scale / off * Vector2d(normal.dot(view_.right()), -normal.dot(view_.up()))};
  // How far casters can be that hide a part of the lamp: those at half of the way.
  const double search_px = std::min(kReach_px, 0.5 * lamp_radius_mm_ / texel_mm);
  double casters = 0.0;
  double caster_nearness = 0.0;
  for (std::size_t i = 0; i < kTaps; i += 2) {
    const Vector2d q = *p + search_px * taps()[i];
    const int x = static_cast<int>(q.x() + 0.5);
    const int y = static_cast<int>(q.y() + 0.5);
    const double near = nearnessAt(x, y);
    if (near <= plane.nearnessAt(x, y) || near == 0.0) continue;
    casters += 1.0;
    caster_nearness += near;
  }
  if (casters == 0.0) return 1.0;
  const double caster_mm = casters / caster_nearness;
  const double depth_mm = 1.0 / plane.nearness;
  const double soft_px =
      std::clamp(lamp_radius_mm_ * (depth_mm - caster_mm) / caster_mm / texel_mm, 0.7, kReach_px - 1.0);
  double sum = 0.0;
  for (const Vector2d& tap : taps()) sum += litAt(plane, *p + soft_px * tap);
  return sum / kTaps;
}

struct Shading::Finish {
  Colour colour;
  double ambient{}, diffuse{};
  double specular{}, sharpness{1.0};  ///< Height and exponent of the highlight.
  double reflection{};
  bool metallic{};  ///< Highlight and reflection have the colour of the metal.
  double emission{};
};

Shading::Finish Shading::finishOf(Look look) {
  switch (look) {
    case Look::kSteel:
      return {{0.42, 0.43, 0.45}, 0.02, 0.42, 0.65, 50.0, 0.26, true};
    case Look::kAluminium:
      return {{0.46, 0.48, 0.50}, 0.03, 0.62, 0.25, 17.0, 0.0, true};
    case Look::kPaint:
      return {{0.030, 0.085, 0.17}, 0.03, 0.8, 0.22, 33.0};
    case Look::kDark:
      return {{0.030, 0.032, 0.037}, 0.06, 0.8, 0.20, 33.0};
    case Look::kBelt:
      return {{0.022, 0.034, 0.032}, 0.04, 0.8, 0.04, 10.0};
    case Look::kBeltHole:
      return {{0.004, 0.005, 0.005}, 0.0, 0.6};
    case Look::kBoard:
      return {{0.80, 0.77, 0.70}, 0.05, 0.72};
    case Look::kPrint:
      return {{0.008, 0.008, 0.012}, 0.03, 0.6};
    case Look::kMirror:
      return {{0.95, 0.74, 0.34}, 0.02, 0.22, 0.9, 250.0, 0.66, true};
    case Look::kAxisX:
      return {{0.70, 0.02, 0.02}, 0.25, 0.6};
    case Look::kAxisY:
      return {{0.01, 0.36, 0.03}, 0.25, 0.6};
    case Look::kAxisZ:
      return {{0.02, 0.07, 0.70}, 0.25, 0.6};
    case Look::kDischarge:
      return {{1.0, 0.28, 0.50}, 0.0, 0.2, 0.0, 1.0, 0.0, false, 0.8};
    case Look::kBore:
      return {{0.55, 0.58, 0.62}, 0.1, 0.7};
    case Look::kGlass:  // Seen through: clearOf().
    case Look::kTube:
    case Look::kLight:
      break;
  }
  return {Colour::Constant(0.92), 0.1, 0.8};
}

Shading::Shading(const twin::Scene& scene, const Viewpoint& view, const Mesh& mesh)
    : lighting_(lightingOf(scene, view)),
      eye_mm_(view.place_mm()),
      floor_z_mm_(scene.floor_z_mm),
      shadows_(mesh, lighting_),
      fill_{{lighting_.fill_mm, kFill}, {lighting_.top_mm, kTop}} {
  if (!scene.beam_on || scene.beam.empty()) return;
  const Vector3d spot = scene.beam.back().p_W_mm;
  const double px = view.pixel_mm(spot);
  spot_ = {spot + Vector3d(0, 0, 9.0 * px), kSpot};
  spot_fade_mm_ = 16.0 * px;
}

Colour Shading::inLight(const Finish& finish, const Vector3d& p_W_mm, const Vector3d& normal) const {
  const auto matt = [&](const Lamp& lamp) {
    const double facing = normal.dot((lamp.place_mm - p_W_mm).normalized());
    return Colour(std::max(facing, 0.0) * finish.diffuse * finish.colour * lamp.colour);
  };
  Colour sum = (finish.ambient + finish.emission) * finish.colour;
  for (const Lamp& lamp : fill_) sum += matt(lamp);
  if (spot_fade_mm_ > 0) {
    const double off = (spot_.place_mm - p_W_mm).norm() / spot_fade_mm_;
    sum += 2.0 / (1.0 + off * off) * matt(spot_);
  }
  const Vector3d to_key = (lighting_.key_mm - p_W_mm).normalized();
  if (!(normal.dot(to_key) > 0)) return sum;
  const double lit = shadows_.lit(p_W_mm, normal);
  if (lit == 0.0) return sum;
  sum += lit * matt({lighting_.key_mm, kKey});
  if (finish.specular > 0) {
    const Vector3d half = (to_key + (eye_mm_ - p_W_mm).normalized()).normalized();
    const double shine = lit * finish.specular * std::pow(std::max(normal.dot(half), 0.0), finish.sharpness);
    sum += shine * kKey * (finish.metallic ? finish.colour : Colour::Ones());
  }
  return sum;
}

Colour Shading::reflected(const Vector3d& p_W_mm, const Vector3d& direction) const {
  if (direction.z() < 0) return 0.9 * kBackground;  // The floor's brightness in the key lamp.
  const double way = (lighting_.panel_mm.z() - p_W_mm.z()) / std::max(direction.z(), 1e-9);
  const Vector3d hit = p_W_mm + way * direction - lighting_.panel_mm;
  const bool panel = way > 0 && std::max(std::abs(hit.x()), std::abs(hit.y())) < lighting_.panel_half_mm;
  return panel ? Colour::Constant(kPanel) : kBackground;
}

Colour Shading::inFog(const Colour& colour, double distance_mm) const {
  const double clear = std::exp(-distance_mm / lighting_.fog_mm);
  return clear * colour + (1.0 - clear) * kBackground;
}

Colour Shading::face(const Face& face, const Vector3d& p_W_mm) const {
  const Finish finish = finishOf(face.look);
  const Vector3d normal = face.normalAt(p_W_mm);
  Colour colour = inLight(finish, p_W_mm, normal);
  if (finish.reflection > 0) {
    const Vector3d in = (p_W_mm - eye_mm_).normalized();
    const Vector3d out = in - 2.0 * in.dot(normal) * normal;
    colour += finish.reflection * finish.colour * reflected(p_W_mm, out);
  }
  return inFog(colour, (p_W_mm - eye_mm_).norm());
}

Colour Shading::beyond(const Vector3d& direction) const {
  const double way = (floor_z_mm_ - eye_mm_.z()) / direction.z();
  if (!(way > 0)) return kBackground;
  const Finish floor{{0.47, 0.49, 0.52}, 0.03, 0.75};
  return inFog(inLight(floor, eye_mm_ + way * direction, Vector3d::UnitZ()), way * direction.norm());
}

}  // namespace kerfbench::scene

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "twin/optics/scan_head.h"
#include "twin/scene/moving_scene.h"
#include "twin/scene/scene_parts.h"

namespace kerfbench::twin {
namespace {

// Frame H of ScanHead, displaced with the machine's frame.
struct HeadFrame {
  Eigen::Matrix3d R_WH;
  Eigen::Vector3d shift_mm;

  [[nodiscard]] Eigen::Vector3d at(double x, double y, double z) const {
    return R_WH * Eigen::Vector3d(x, y, z) + shift_mm;
  }
  [[nodiscard]] Eigen::Vector3d along(double x, double y, double z) const {
    return R_WH * Eigen::Vector3d(x, y, z);
  }
};

struct Mirror {
  const char* name;
  Eigen::Vector3d place_mm;
  Eigen::Vector3d axis;
  Eigen::Vector3d normal;
  Eigen::Vector2d radius_mm;  // Radii along the axis and across it.
};

const Eigen::Vector3d kDown(0.0, 0.0, -1.0);
constexpr double kTubeGap = 3.4;  // Gap between tube and head, in radii of the tube.
double tubeRadius_mm(double throw_mm) { return std::clamp(0.042 * throw_mm, 12.0, 40.0); }

// A box in H. R_WH is a quarter turn: a box stays a box.
struct HeadBox {
  Eigen::Vector3d a, b;  // Two corners, in H.
  double edge_mm{0.0};
};

void headBox(SceneBuilder& build, const HeadFrame& H, const std::string& name, Material material,
             const HeadBox& box) {
  const auto& [a, b, edge_mm] = box;
  const Eigen::Vector3d p = H.at(a.x(), a.y(), a.z());
  const Eigen::Vector3d q = H.at(b.x(), b.y(), b.z());
  build.box(name, material, p.cwiseMin(q), p.cwiseMax(q), edge_mm);
}

// Normal of a mirror that at rest turns `in` into `out`, after its motor has turned it.
Eigen::Vector3d turnedNormal(const Eigen::Vector3d& in, const Eigen::Vector3d& out,
                             const Eigen::Vector3d& axis, const MirrorAlignment& alignment,
                             double motor_rad) {
  Eigen::Vector3d rest = out - in;
  rest = (rest - rest.dot(axis) * axis).normalized();
  const double angle = alignment.zero_rad + alignment.scale * motor_rad;
  return std::cos(angle) * rest + std::sin(angle) * axis.cross(rest);
}

Eigen::Vector3d onPlane(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                        const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
  return from + (place - from).dot(normal) / direction.dot(normal) * direction;
}

void addMirror(SceneBuilder& build, const Mirror& mirror, const Eigen::Vector3d& motor_side, double size_mm) {
  build.on(mirror.name);
  build.disc(mirror.name, Material::kMirror,
             {mirror.place_mm, mirror.normal, mirror.axis, mirror.radius_mm, 0.12 * size_mm});
  build.on(body_name::kHead);
  const Eigen::Vector3d edge = mirror.place_mm + mirror.radius_mm.x() * motor_side;
  const std::string motor = std::string(mirror.name) + " motor";
  build.cylinder(motor, Material::kSteel, edge - 0.12 * size_mm * motor_side,
                 edge + 0.4 * size_mm * motor_side, 0.22 * size_mm);
  build.cylinder(motor, Material::kAluminium, edge + 0.3 * size_mm * motor_side,
                 edge + 0.6 * size_mm * motor_side, 0.85 * size_mm);
  build.cylinder(motor, Material::kDark, edge + 0.6 * size_mm * motor_side, edge + 3.0 * size_mm * motor_side,
                 0.75 * size_mm);
}

struct Housing {
  Eigen::Vector3d min, max;  // Corners in H.
};

// Adds two walls and the floor: towards the reader, and above, the head is cut open.
void addHousing(SceneBuilder& build, const HeadFrame& H, const Housing& h, double size_mm) {
  const double wall = 0.12 * size_mm;
  const double w = 1.6 * size_mm;  // Half of the opening for the leaving beam.
  const auto& [a, b] = h;
  const auto plate = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    headBox(build, H, "scan head", Material::kAluminium, {p, q});
  };
  plate({a.x(), b.y() - wall, a.z()}, {b.x(), b.y(), b.z()});
  plate({b.x() - wall, a.y(), a.z()}, {b.x(), b.y() - wall, b.z()});
  plate({a.x(), a.y(), a.z()}, {-w, b.y() - wall, a.z() + wall});
  plate({w, a.y(), a.z()}, {b.x() - wall, b.y() - wall, a.z() + wall});
  plate({-w, w, a.z()}, {w, b.y() - wall, a.z() + wall});
  plate({-w, a.y(), a.z()}, {w, -w, a.z() + wall});
  headBox(build, H, "window", Material::kGlass, {{-w, -w, a.z() + 0.3 * wall}, {w, w, a.z() + 0.7 * wall}});
}

// Adds the column behind the conveyor, at y = `back_mm`, that carries the rail at a place of H. It is part of
// the machine's frame and moves with it.
void addColumn(SceneBuilder& build, const HeadFrame& H, const Eigen::Vector3d& rail_H_mm, double radius_mm,
               double back_mm) {
  const Eigen::Vector3d rail = H.along(rail_H_mm.x(), rail_H_mm.y(), rail_H_mm.z());
  const double half = 1.3 * radius_mm;
  Scene& scene = build.scene();
  const auto box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high, double edge_mm) {
    build.box("column", Material::kPaint, low + H.shift_mm, high + H.shift_mm, edge_mm);
  };
  box({rail.x() - half, back_mm - half, scene.floor_z_mm},
      {rail.x() + half, back_mm + half, rail.z() + 1.3 * radius_mm}, 3.0);
  box({rail.x() - 2.2 * half, back_mm - 1.8 * half, scene.floor_z_mm},
      {rail.x() + 2.2 * half, back_mm + 1.8 * half, scene.floor_z_mm + 0.4 * radius_mm}, 2.0);
  box({rail.x() - 0.8 * half, std::min(rail.y(), back_mm), rail.z() - 0.6 * radius_mm},
      {rail.x() + 0.8 * half, std::max(rail.y(), back_mm), rail.z() + 0.6 * radius_mm}, 2.0);
  scene.overall.extend(Eigen::Vector3d(rail.x(), back_mm + half, rail.z()));
}

// Place of the tube, the rail that carries it and the head, and the column behind the conveyor.
struct TubePlace {
  double d_mm, L_mm;  // Spacing of the mirrors, throw.
  double tube_mm;     // Length of the tube.
};

void addTubeAndColumn(SceneBuilder& build, const HeadFrame& H, const Housing& h, const TubePlace& place,
                      const ConveyorLayout& layout) {
  const auto& [d_mm, L_mm, tube_mm] = place;
  const double radius = tubeRadius_mm(L_mm);
  const double gap = kTubeGap * radius;
  const double end = h.min.x() - gap;
  const double start = end - tube_mm;
  const double inside = 0.2 * radius;  // Radius of the glass, which ends within its flanges.
  build.cylinder("laser tube", Material::kTube, H.at(start + inside, -d_mm, L_mm),
                 H.at(end - inside, -d_mm, L_mm), radius);
  for (const double x : {start, end}) {
    const double s = x == start ? 1.0 : -1.0;
    build.cylinder("laser tube", Material::kSteel, H.at(x, -d_mm, L_mm),
                   H.at(x + s * 0.9 * radius, -d_mm, L_mm), 1.18 * radius);
  }
  build.cylinder("laser tube", Material::kDark, H.at(end, -d_mm, L_mm), H.at(end + 0.3 * radius, -d_mm, L_mm),
                 0.45 * radius);
  const double rail_y = std::max(h.max.y(), -d_mm + 1.3 * radius);
  headBox(build, H, "rail", Material::kAluminium,
          {{start + radius, rail_y, L_mm - 0.8 * radius},
           {h.max.x(), rail_y + 1.4 * radius, L_mm + 0.8 * radius},
           2.0});
  for (const double x : {start + 0.18 * tube_mm, end - 0.18 * tube_mm}) {
    headBox(build, H, "tube clamp", Material::kPaint,
            {{x - 0.35 * radius, -d_mm - 1.25 * radius, L_mm - 1.25 * radius},
             {x + 0.35 * radius, rail_y, L_mm + 1.25 * radius},
             2.0});
  }
  addColumn(build, H, {end - 0.35 * tube_mm, rail_y + 0.7 * radius, L_mm}, radius,
            layout.frame_y_mm + 3.2 * radius);
  // Scales and view stand still while the frame trembles.
  Scene& scene = build.scene();
  const HeadFrame rest{H.R_WH, Eigen::Vector3d::Zero()};
  scene.overall.extend(rest.at(start, -d_mm - 1.3 * radius, L_mm + 1.4 * radius));
  scene.overall.extend(rest.at(h.max.x(), h.min.y(), h.max.z()));
}

void addLens(SceneBuilder& build, const HeadFrame& H, const LensDescription& lens, double z_mm,
             double size_mm) {
  const Eigen::Vector3d centre =
      H.at(0, 0, z_mm) + Eigen::Vector3d(lens.decentre_mm[0], lens.decentre_mm[1], 0);
  build.cylinder("f-theta lens", Material::kDark, centre - Eigen::Vector3d(0, 0, 0.5 * size_mm),
                 centre + Eigen::Vector3d(0, 0, 0.5 * size_mm), 1.75 * size_mm, 1.5 * size_mm);
  build.cylinder("f-theta lens", Material::kGlass, centre - Eigen::Vector3d(0, 0, 0.3 * size_mm),
                 centre + Eigen::Vector3d(0, 0, 0.3 * size_mm), 1.5 * size_mm);
}

// The two mirrors as the beam meets them.
std::array<Mirror, 2> mirrorsOf(const ScanHeadDescription& head, const ScanHead& optics, const HeadFrame& H,
                                const Eigen::Vector2d& mirror_rad, double size_mm) {
  const Eigen::Vector3d in = H.along(1, 0, 0);
  const Eigen::Vector3d across = H.along(0, 1, 0);
  Mirror x{body_name::kXMirror, optics.xMirrorPlace_mm() + H.shift_mm, optics.xMirrorAxis(), {}, {}};
  Mirror y{body_name::kYMirror, optics.yMirrorPlace_mm() + H.shift_mm, optics.yMirrorAxis(), {}, {}};
  Mirror& first = head.y_mirror_first ? y : x;
  Mirror& last = head.y_mirror_first ? x : y;
  const MirrorAlignment& of_first = head.y_mirror_first ? head.y : head.x;
  const MirrorAlignment& of_last = head.y_mirror_first ? head.x : head.y;
  first.normal = turnedNormal(in, across, first.axis, of_first, mirror_rad[head.y_mirror_first ? 1 : 0]);
  last.normal = turnedNormal(across, kDown, last.axis, of_last, mirror_rad[head.y_mirror_first ? 0 : 1]);
  first.radius_mm = {0.36 * size_mm, 0.5 * size_mm};
  last.radius_mm = {0.8 * size_mm, 0.5 * size_mm};
  return {first, last};
}

// Corner points of the beam from the tube to the last mirror, and to the lens if there is one.
std::vector<Eigen::Vector3d> pathInHead(const std::array<Mirror, 2>& mirrors, const Eigen::Vector3d& start,
                                        const Eigen::Vector3d& in, std::optional<double> lens_z_mm) {
  const auto& [first, last] = mirrors;
  const Eigen::Vector3d at_first = onPlane(start, in, first.place_mm, first.normal);
  const Eigen::Vector3d between = in - 2.0 * in.dot(first.normal) * first.normal;
  const Eigen::Vector3d at_last = onPlane(at_first, between, last.place_mm, last.normal);
  std::vector<Eigen::Vector3d> path{start, at_first, at_last};
  if (lens_z_mm) {
    const Eigen::Vector3d leaving = between - 2.0 * between.dot(last.normal) * last.normal;
    path.push_back(onPlane(at_last, leaving, {0, 0, *lens_z_mm}, kDown));
  }
  return path;
}

std::vector<BeamPoint> withRadii(const std::vector<Eigen::Vector3d>& path, const BeamDescription& beam) {
  std::vector<BeamPoint> points(path.size());
  double left_mm = -beam.focus_z_mm;
  for (std::size_t i = path.size(); i-- > 0;) {
    if (i + 1 < path.size()) left_mm += (path[i + 1] - path[i]).norm();
    points[i] = {path[i], beamRadius_mm(beam, left_mm)};
  }
  // The laser's beam is as wide as at the first mirror: what makes it converge sits at the tube's end.
  points[0].radius_mm = points[1].radius_mm;
  return points;
}

}  // namespace

namespace {

// Dimensions that the head's description does not give.
double headSize_mm(const ScanHeadDescription& head) { return std::clamp(head.mirror_spacing_mm, 8.0, 40.0); }

Housing housingOf(const ScanHeadDescription& head) {
  const double size = headSize_mm(head);
  const double d = head.mirror_spacing_mm;
  const double L = head.throw_mm;
  return {{-2.6 * size, -d - 2.0 * size, L - 1.9 * size}, {4.6 * size, 2.0 * size, L + 4.2 * size}};
}

std::optional<double> lensPlane_mm(const ScanHeadDescription& head) {
  if (!head.lens) return std::nullopt;
  return head.throw_mm - 2.4 * headSize_mm(head);
}

// Where the tube's beam leaves it.
Eigen::Vector3d tubesEnd(const ScanHeadDescription& head, const HeadFrame& H) {
  return H.at(housingOf(head).min.x() - kTubeGap * tubeRadius_mm(head.throw_mm), -head.mirror_spacing_mm,
              head.throw_mm);
}

HeadFrame headFrame(const ScanHeadDescription& head, const Eigen::Vector2d& frame_mm) {
  HeadFrame H{Eigen::Matrix3d::Identity(), {frame_mm.x(), frame_mm.y(), 0.0}};
  if (head.y_mirror_first) H.R_WH << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  return H;
}

}  // namespace

void addMirrorBeam(MovingScene& moving, const MachineDescription& machine) {
  const ScanHeadDescription& head = machine.head;
  const HeadFrame H = headFrame(head, Eigen::Vector2d::Zero());
  const Eigen::Vector3d in = H.along(1, 0, 0);
  const auto mirrors =
      mirrorsOf(head, ScanHead(head, machine.beam), H, Eigen::Vector2d::Zero(), headSize_mm(head));
  const std::optional<double> lens_z_mm = lensPlane_mm(head);
  auto path = pathInHead(mirrors, tubesEnd(head, H), in, lens_z_mm);
  path.emplace_back(0.0, 0.0, 0.0);
  const std::vector<BeamPoint> points = withRadii(path, machine.beam);
  moving.beam.push_back(
      {BeamCorner::Kind::kRides, moving.bodyNamed(body_name::kHead), path[0], in, points[0].radius_mm});
  for (std::size_t i = 0; i < 2; ++i) {
    moving.beam.push_back(
        {BeamCorner::Kind::kMirror, moving.partNamed(mirrors.at(i).name), {}, {}, points[i + 1].radius_mm});
  }
  if (lens_z_mm)
    moving.beam.push_back({BeamCorner::Kind::kPlane, -1, {0, 0, *lens_z_mm}, kDown, points[3].radius_mm});
  moving.spot_radius_mm = points.back().radius_mm;
}

void addMirrorHead(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
                   const ConveyorLayout& layout) {
  const ScanHeadDescription& head = machine.head;
  const ScanHead optics(head, machine.beam);
  const double L = head.throw_mm;
  const double d = head.mirror_spacing_mm;
  const double size = headSize_mm(head);
  const HeadFrame H = headFrame(head, pose.frame_mm);
  const Eigen::Vector3d in = H.along(1, 0, 0);
  const auto mirrors = mirrorsOf(head, optics, H, pose.mirror_rad, size);
  const auto& [first, last] = mirrors;
  addMirror(build, first, {0, 0, 1}, size);
  addMirror(build, last, in, size);
  const Housing housing = housingOf(head);
  addHousing(build, H, housing, size);
  addTubeAndColumn(build, H, housing, {d, L, std::max(0.75 * L, 200.0)}, layout);
  const std::optional<double> lens_z_mm = lensPlane_mm(head);
  if (lens_z_mm) addLens(build, H, *head.lens, *lens_z_mm, size);

  Scene& scene = build.scene();
  scene.head_labels = {{first.name, first.place_mm + Eigen::Vector3d(0, 0, 1.9 * size)},
                       {last.name, last.place_mm + 2.4 * size * in + 1.1 * size * kDown}};
  scene.head.extend(H.at(-2.2 * size, -d - 1.0 * size, L - 1.7 * size));
  scene.head.extend(H.at(2.5 * size, 1.2 * size, L + 2.2 * size));
  scene.head_view = H.along(0.78, 0.46, 0.17).normalized();
  const auto spot = optics.spotAt(pose.mirror_rad, pose.frame_mm, Surface(machine.surface), pose.time_s);
  if (!spot) return;
  auto path = pathInHead(mirrors, tubesEnd(head, H), in, lens_z_mm);
  path.emplace_back(spot->p_WQ_mm.x(), spot->p_WQ_mm.y(), spot->height_mm);
  scene.beam = withRadii(path, machine.beam);
}

}  // namespace kerfbench::twin

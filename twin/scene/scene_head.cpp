// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "twin/optics/scan_head.h"
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
  build.disc(mirror.name, Material::kMirror,
             {mirror.place_mm, mirror.normal, mirror.axis, mirror.radius_mm, 0.12 * size_mm});
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
  Scene& scene = build.scene();
  const Eigen::Vector3d rail = H.at(end - 0.35 * tube_mm, rail_y + 0.7 * radius, L_mm);
  const double back = layout.frame_y_mm + 3.2 * radius;
  const double half = 1.3 * radius;
  build.box("column", Material::kPaint, {rail.x() - half, back - half, scene.floor_z_mm},
            {rail.x() + half, back + half, L_mm + 1.3 * radius}, 3.0);
  build.box("column", Material::kPaint, {rail.x() - 2.2 * half, back - 1.8 * half, scene.floor_z_mm},
            {rail.x() + 2.2 * half, back + 1.8 * half, scene.floor_z_mm + 0.4 * radius}, 2.0);
  build.box("column", Material::kPaint,
            {rail.x() - 0.8 * half, std::min(rail.y(), back), L_mm - 0.6 * radius},
            {rail.x() + 0.8 * half, std::max(rail.y(), back), L_mm + 0.6 * radius}, 2.0);
  scene.overall.extend(H.at(start, -d_mm - 1.3 * radius, L_mm + 1.4 * radius));
  scene.overall.extend(H.at(h.max.x(), h.min.y(), h.max.z()));
  scene.overall.extend(Eigen::Vector3d(rail.x(), back + half, L_mm));
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
  Mirror x{"x mirror", optics.xMirrorPlace_mm() + H.shift_mm, optics.xMirrorAxis(), {}, {}};
  Mirror y{"y mirror", optics.yMirrorPlace_mm() + H.shift_mm, optics.yMirrorAxis(), {}, {}};
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

void addMirrorHead(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
                   const ConveyorLayout& layout) {
  const ScanHeadDescription& head = machine.head;
  const ScanHead optics(head, machine.beam);
  const double L = head.throw_mm;
  const double d = head.mirror_spacing_mm;
  const double size = std::clamp(d, 8.0, 40.0);
  HeadFrame H{Eigen::Matrix3d::Identity(), {pose.frame_mm.x(), pose.frame_mm.y(), 0.0}};
  if (head.y_mirror_first) H.R_WH << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  const Eigen::Vector3d in = H.along(1, 0, 0);
  const auto mirrors = mirrorsOf(head, optics, H, pose.mirror_rad, size);
  const auto& [first, last] = mirrors;
  addMirror(build, first, {0, 0, 1}, size);
  addMirror(build, last, in, size);
  const Housing housing{{-2.6 * size, -d - 2.0 * size, L - 1.9 * size},
                        {4.6 * size, 2.0 * size, L + 4.2 * size}};
  addHousing(build, H, housing, size);
  addTubeAndColumn(build, H, housing, {d, L, std::max(0.75 * L, 200.0)}, layout);
  std::optional<double> lens_z_mm;
  if (head.lens) {
    lens_z_mm = L - 2.4 * size;
    addLens(build, H, *head.lens, *lens_z_mm, size);
  }

  Scene& scene = build.scene();
  scene.head_labels = {{first.name, first.place_mm + Eigen::Vector3d(0, 0, 1.9 * size)},
                       {last.name, last.place_mm + 2.4 * size * in + 1.1 * size * kDown}};
  scene.head.extend(H.at(-2.2 * size, -d - 1.0 * size, L - 1.7 * size));
  scene.head.extend(H.at(2.5 * size, 1.2 * size, L + 2.2 * size));
  scene.head_view = H.along(0.78, 0.46, 0.17).normalized();
  const auto spot = optics.spotAt(pose.mirror_rad, pose.frame_mm, Surface(machine.surface), pose.time_s);
  if (!spot) return;
  const Eigen::Vector3d start = H.at(housing.min.x() - kTubeGap * tubeRadius_mm(L), -d, L);
  auto path = pathInHead(mirrors, start, in, lens_z_mm);
  path.emplace_back(spot->p_WQ_mm.x(), spot->p_WQ_mm.y(), spot->height_mm);
  scene.beam = withRadii(path, machine.beam);
}

}  // namespace kerfbench::twin

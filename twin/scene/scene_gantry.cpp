// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "twin/optics/scan_head.h"
#include "twin/scene/moving_scene.h"
#include "twin/scene/scene_parts.h"

namespace kerfbench::twin {
namespace {

// Layout of flying optics: the tube lies still, across the line; a mirror at its end turns the beam along x,
// one on the bridge turns it along y, one on the carriage turns it down.
struct GantryLayout {
  double rail_y_mm{};  // Places of the two rails, ±.
  double rail_z_mm{};  // Height of the rails' upper face.
  double beam_z_mm{};  // Height of the beam.
  double rail_min_x_mm{}, rail_max_x_mm{};
  double tube_x_mm{};
  double size_mm{};  // Size of mirrors and of what holds them.
};

void addFlatMirror(SceneBuilder& build, const std::string& name, const Eigen::Vector3d& place_mm,
                   const Eigen::Vector3d& in, const Eigen::Vector3d& out, double size_mm) {
  const Eigen::Vector3d normal = (out - in).normalized();
  const Eigen::Vector3d along = in.cross(out).normalized();
  build.disc(name, Material::kMirror,
             {place_mm, normal, along, {0.5 * size_mm, 0.62 * size_mm}, 0.1 * size_mm});
  build.disc(
      name, Material::kDark,
      {place_mm - 0.11 * size_mm * normal, normal, along, {0.62 * size_mm, 0.74 * size_mm}, 0.22 * size_mm});
}

void addRails(SceneBuilder& build, const GantryLayout& at) {
  const double s = at.size_mm;
  Scene& scene = build.scene();
  for (const double side : {-1.0, 1.0}) {
    const double y = side * at.rail_y_mm;
    const double low = at.rail_z_mm - 1.5 * s;
    build.box("gantry rail", Material::kPaint, {at.rail_min_x_mm, y - 0.45 * s, low},
              {at.rail_max_x_mm, y + 0.45 * s, at.rail_z_mm - 0.14 * s}, 3.0);
    build.cylinder("gantry rail", Material::kSteel, {at.rail_min_x_mm + 0.2 * s, y, at.rail_z_mm - 0.1 * s},
                   {at.rail_max_x_mm - 0.2 * s, y, at.rail_z_mm - 0.1 * s}, 0.14 * s);
    for (const double x :
         {at.rail_min_x_mm + s, 0.5 * (at.rail_min_x_mm + at.rail_max_x_mm), at.rail_max_x_mm - s}) {
      build.box("gantry rail", Material::kPaint, {x - 0.4 * s, y - 0.4 * s, scene.floor_z_mm},
                {x + 0.4 * s, y + 0.4 * s, low}, 2.0);
    }
  }
  scene.overall.extend(Eigen::Vector3d(at.rail_min_x_mm, -at.rail_y_mm - 0.45 * s, scene.floor_z_mm));
  scene.overall.extend(Eigen::Vector3d(at.rail_max_x_mm, at.rail_y_mm + 0.45 * s, at.rail_z_mm));
}

void addBridge(SceneBuilder& build, const GantryLayout& at, double x_mm, const Eigen::Vector3d& shift_mm) {
  const double s = at.size_mm;
  const double z = at.rail_z_mm;
  const auto p = [&](double x, double y, double height) {
    return Eigen::Vector3d(x_mm + x + shift_mm.x(), y + shift_mm.y(), height + shift_mm.z());
  };
  build.box("bridge", Material::kAluminium, p(-1.75 * s, -at.rail_y_mm - 0.6 * s, z + 0.35 * s),
            p(-0.75 * s, at.rail_y_mm + 0.3 * s, z + 1.55 * s), 3.0);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * at.rail_y_mm;
    build.box("bridge", Material::kPaint, p(-2.1 * s, y - 0.5 * s, z), p(0.1 * s, y + 0.5 * s, z + 0.4 * s),
              3.0);
  }
  // The bracket stands behind the mirror.
  build.box("bridge", Material::kAluminium, p(0.26 * s, at.rail_y_mm + 0.02 * s, z),
            p(0.46 * s, at.rail_y_mm + 0.5 * s, z + 1.75 * s), 1.0);
  build.box("bridge", Material::kAluminium, p(-2.0 * s, at.rail_y_mm + 0.02 * s, z + 0.2 * s),
            p(0.46 * s, at.rail_y_mm + 0.5 * s, z + 0.4 * s), 1.0);
  for (const double height : {0.55, 1.35}) {
    build.cylinder("bridge guide", Material::kSteel, p(-0.7 * s, -at.rail_y_mm, z + height * s),
                   p(-0.7 * s, at.rail_y_mm, z + height * s), 0.09 * s);
  }
  build.box("bridge motor", Material::kDark, p(-1.7 * s, -at.rail_y_mm - 1.7 * s, z + 0.5 * s),
            p(-0.8 * s, -at.rail_y_mm - 0.6 * s, z + 1.4 * s), 3.0);
}

// Adds the head at the bridge's front; its nozzle is glass, so that the beam is seen to its end.
void addCarriage(SceneBuilder& build, const GantryLayout& at, const Eigen::Vector2d& p_mm,
                 const Eigen::Vector3d& shift_mm) {
  const double s = at.size_mm;
  const auto p = [&](double x, double y, double z) {
    return Eigen::Vector3d(p_mm.x() + x + shift_mm.x(), p_mm.y() + y + shift_mm.y(), z + shift_mm.z());
  };
  build.box("carriage", Material::kPaint, p(-0.68 * s, -1.0 * s, at.rail_z_mm + 0.1 * s),
            p(-0.5 * s, 1.0 * s, at.rail_z_mm + 1.9 * s), 2.0);
  build.box("carriage", Material::kPaint, p(-0.5 * s, -0.8 * s, at.beam_z_mm - 1.3 * s),
            p(-0.42 * s, 0.8 * s, at.beam_z_mm + 0.9 * s), 1.0);
  build.cylinder("nozzle", Material::kAluminium, p(0, 0, at.beam_z_mm - 1.25 * s),
                 p(0, 0, at.beam_z_mm - 0.95 * s), 0.55 * s, 0.4 * s);
  build.cylinder("nozzle", Material::kGlass, p(0, 0, at.beam_z_mm - 1.6 * s),
                 p(0, 0, at.beam_z_mm - 1.25 * s), 0.42 * s, 0.36 * s);
  build.cylinder("nozzle", Material::kSteel, p(0, 0, at.beam_z_mm - 1.85 * s),
                 p(0, 0, at.beam_z_mm - 1.6 * s), 0.3 * s, 0.15 * s);
  build.box("carriage", Material::kAluminium, p(-0.5 * s, -0.62 * s, at.beam_z_mm - 0.1 * s),
            p(0.1 * s, -0.32 * s, at.beam_z_mm + 0.3 * s), 1.0);
  build.box("carriage", Material::kAluminium, p(-0.5 * s, -0.5 * s, at.beam_z_mm - 1.2 * s),
            p(-0.1 * s, 0.5 * s, at.beam_z_mm - 0.98 * s), 1.0);
}

void addTube(SceneBuilder& build, const GantryLayout& at, const ConveyorLayout& layout) {
  const double r = 0.6 * at.size_mm;
  const double end = at.rail_y_mm - 1.6 * at.size_mm;
  const double start = -0.8 * layout.half_width_mm;
  const auto p = [&](double y) { return Eigen::Vector3d(at.tube_x_mm, y, at.beam_z_mm); };
  build.cylinder("laser tube", Material::kTube, p(start + 0.2 * r), p(end - 0.2 * r), r);
  build.cylinder("laser tube", Material::kSteel, p(start), p(start + 0.9 * r), 1.18 * r);
  build.cylinder("laser tube", Material::kSteel, p(end - 0.9 * r), p(end), 1.18 * r);
  build.cylinder("laser tube", Material::kDark, p(end), p(end + 0.4 * r), 0.45 * r);
  const double under = at.beam_z_mm - 1.3 * r;
  build.box("tube bridge", Material::kPaint,
            {at.tube_x_mm - r, -at.rail_y_mm - 0.4 * at.size_mm, under - 1.2 * r},
            {at.tube_x_mm + r, at.rail_y_mm + 0.4 * at.size_mm, under}, 3.0);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * at.rail_y_mm;
    build.box("tube bridge", Material::kPaint,
              {at.tube_x_mm - r, y - 0.4 * at.size_mm, build.scene().floor_z_mm},
              {at.tube_x_mm + r, y + 0.4 * at.size_mm, under - 1.2 * r}, 3.0);
  }
  // The box is the post of the corner mirror.
  build.box("tube bridge", Material::kAluminium, {at.tube_x_mm - 0.6 * r, at.rail_y_mm + 0.2 * r, under - r},
            {at.tube_x_mm - 0.2 * r, at.rail_y_mm + 0.6 * r, at.beam_z_mm}, 1.0);
  for (const double y : {start + 0.2 * (end - start), end - 0.2 * (end - start)}) {
    build.box("tube clamp", Material::kPaint, {at.tube_x_mm - 1.2 * r, y - 0.4 * r, under},
              {at.tube_x_mm + 1.2 * r, y + 0.4 * r, at.beam_z_mm + 1.2 * r}, 3.0);
  }
  Scene& scene = build.scene();
  scene.overall.extend(Eigen::Vector3d(at.tube_x_mm - 1.3 * r, start, at.beam_z_mm + 1.3 * r));
}

GantryLayout gantryLayout(const MachineDescription& machine, const ConveyorLayout& layout) {
  GantryLayout at;
  at.size_mm = std::clamp(0.1 * layout.half_width_mm, 20.0, 60.0);
  at.rail_y_mm = layout.frame_y_mm + 0.9 * at.size_mm;
  at.rail_z_mm = 0.5 * at.size_mm;
  at.beam_z_mm = at.rail_z_mm + 1.75 * at.size_mm;
  at.rail_min_x_mm = machine.travel_min_mm[0] - 2.6 * at.size_mm;
  at.rail_max_x_mm = machine.travel_max_mm[0] + 1.4 * at.size_mm;
  at.tube_x_mm = at.rail_min_x_mm - 0.9 * at.size_mm;
  return at;
}

// Where the tube's beam leaves it.
Eigen::Vector3d leavesTube(const GantryLayout& at) {
  return {at.tube_x_mm, at.rail_y_mm - 1.6 * at.size_mm, at.beam_z_mm};
}

}  // namespace

void addGantryBeam(MovingScene& moving, const MachineDescription& machine, const ConveyorLayout& layout) {
  const GantryLayout at = gantryLayout(machine, layout);
  const double wide_mm = beamRadius_mm(machine.beam, at.beam_z_mm - machine.beam.focus_z_mm);
  const auto rides = [&](const Eigen::Vector3d& p_mm, const char* body) {
    moving.beam.push_back({BeamCorner::Kind::kRides, moving.bodyNamed(body), p_mm, {}, wide_mm});
  };
  rides(leavesTube(at), "");
  rides({at.tube_x_mm, at.rail_y_mm, at.beam_z_mm}, "");
  rides({0.0, at.rail_y_mm, at.beam_z_mm}, body_name::kBridgeMirror);
  rides({0.0, 0.0, at.beam_z_mm}, body_name::kCarriage);
  moving.spot_radius_mm = beamRadius_mm(machine.beam, -machine.beam.focus_z_mm);
}

void addGantry(SceneBuilder& build, const MachineDescription& machine, const MachinePose& pose,
               const ConveyorLayout& layout) {
  const GantryLayout at = gantryLayout(machine, layout);
  const Eigen::Vector3d shift(pose.frame_mm.x(), pose.frame_mm.y(), 0.0);
  const Eigen::Vector2d p_mm(pose.gantry_mm.x() - machine.squareness_rad * pose.gantry_mm.y(),
                             pose.gantry_mm.y());
  addRails(build, at);
  addTube(build, at, layout);
  build.on(body_name::kBridge);
  addBridge(build, at, pose.gantry_mm.x(), shift);
  build.on(body_name::kCarriage);
  addCarriage(build, at, p_mm, shift);

  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d corner(at.tube_x_mm, at.rail_y_mm, at.beam_z_mm);
  const Eigen::Vector3d on_bridge = Eigen::Vector3d(p_mm.x(), at.rail_y_mm, at.beam_z_mm) + shift;
  const Eigen::Vector3d on_carriage = Eigen::Vector3d(p_mm.x(), p_mm.y(), at.beam_z_mm) + shift;
  build.on("");
  addFlatMirror(build, "corner mirror", corner, y, x, at.size_mm);
  build.on(body_name::kBridgeMirror);
  addFlatMirror(build, "bridge mirror", on_bridge, x, -y, at.size_mm);
  build.on(body_name::kCarriage);
  addFlatMirror(build, "carriage mirror", on_carriage, -y, -z, at.size_mm);

  Scene& scene = build.scene();
  const double s = at.size_mm;
  scene.head.extend(on_carriage + Eigen::Vector3d(-2.0 * s, -2.2 * s, -2.3 * s));
  scene.head.extend(on_carriage + Eigen::Vector3d(2.0 * s, 2.2 * s, 1.2 * s));
  scene.head_view = Eigen::Vector3d(-0.80, -0.50, -0.40).normalized();
  scene.head_labels = {{"carriage", on_carriage + Eigen::Vector3d(-0.5 * s, 0.0, 1.0 * s)}};
  const auto spot = gantrySpot(p_mm + pose.frame_mm, machine.beam, Surface(machine.surface), pose.time_s);
  if (!spot) return;
  const Eigen::Vector3d p_WQ(spot->p_WQ_mm.x(), spot->p_WQ_mm.y(), spot->height_mm);
  const double wide_mm = beamRadius_mm(machine.beam, at.beam_z_mm - machine.beam.focus_z_mm);
  const double at_board_mm = beamRadius_mm(machine.beam, p_WQ.z() - machine.beam.focus_z_mm);
  scene.beam = {{leavesTube(at), wide_mm},
                {corner, wide_mm},
                {on_bridge, wide_mm},
                {on_carriage, wide_mm},
                {p_WQ, at_board_mm}};
}

}  // namespace kerfbench::twin

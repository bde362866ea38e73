// SPDX-License-Identifier: Apache-2.0
#include "twin/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "twin/scene/scene_parts.h"

namespace kerfbench::twin {
namespace {

// A round length near a fifth of the span of the picture.
double scaleBar_mm(double span_mm) {
  double bar_mm = 1.0;
  for (const double next_mm : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4}) {
    if (next_mm <= span_mm / 5.0) bar_mm = next_mm;
  }
  return bar_mm;
}

std::string lengthText(double mm) { return std::to_string(std::lround(mm)) + " mm"; }

// Adds a scale bar of five fields on the floor before the machine.
void addScaleBar(SceneBuilder& build, double bar_mm, const Eigen::Vector3d& corner) {
  const double width_mm = bar_mm / 12.0;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d low = corner + Eigen::Vector3d(bar_mm / 5.0 * i, 0.0, 0.0);
    build.box("scale bar", i % 2 == 0 ? Material::kDark : Material::kLight, low,
              low + Eigen::Vector3d(bar_mm / 5.0, width_mm, width_mm / 10.0));
  }
  const Eigen::Vector3d end = corner + Eigen::Vector3d(1.04 * bar_mm, 0.5 * width_mm, 0.0);
  build.scene().labels.push_back({lengthText(bar_mm), end});
}

// Adds W's axes as directions: at W's origin they would stand in the beam.
void addAxes(SceneBuilder& build, double length_mm, const Eigen::Vector3d& origin) {
  const std::array<Material, 3> materials{Material::kAxisX, Material::kAxisY, Material::kAxisZ};
  const std::array<const char*, 3> names{"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(i);
    const auto n = static_cast<std::size_t>(i);
    build.arrow(std::string("axis ") + names.at(n), materials.at(n), origin, direction, length_mm);
    build.scene().labels.push_back({names.at(n), origin + 1.18 * length_mm * direction});
  }
}

void addScales(SceneBuilder& build) {
  Scene& scene = build.scene();
  const double bar_mm = scaleBar_mm(scene.overall.sizes().x());
  const Eigen::Vector3d corner(scene.overall.min().x(), scene.overall.min().y() - 0.75 * bar_mm,
                               scene.floor_z_mm);
  addScaleBar(build, bar_mm, corner);
  addAxes(build, 0.55 * bar_mm, corner + Eigen::Vector3d(0.0, 0.28 * bar_mm, 0.02 * bar_mm));
  scene.overall.extend(corner);
}

}  // namespace

Eigen::Isometry3d frameAlong(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& z,
                             const Eigen::Vector3d& along) {
  const Eigen::Vector3d x = (along - along.dot(z) * z).normalized();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear().col(0) = x;
  X.linear().col(1) = z.cross(x);
  X.linear().col(2) = z;
  X.translation() = origin_mm;
  return X;
}

void SceneBuilder::box(const std::string& name, Material material, const Eigen::Vector3d& min_mm,
                       const Eigen::Vector3d& max_mm, double edge_radius_mm) {
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
  X_WP.translation() = 0.5 * (min_mm + max_mm);
  add(name, material, X_WP, Box{max_mm - min_mm, edge_radius_mm});
}

void SceneBuilder::cylinder(const std::string& name, Material material, const Eigen::Vector3d& from_mm,
                            const Eigen::Vector3d& to_mm, double radius_mm, double bore_mm) {
  const Eigen::Vector3d along = to_mm - from_mm;
  const Eigen::Vector3d z = along.normalized();
  const Eigen::Vector3d across = Eigen::Vector3d::Unit(std::abs(z.x()) < 0.9 ? 0 : 1);
  add(name, material, frameAlong(0.5 * (from_mm + to_mm), z, across),
      Cylinder{radius_mm, along.norm(), bore_mm});
}

void SceneBuilder::disc(const std::string& name, Material material, const PlacedDisc& disc) {
  add(name, material, frameAlong(disc.centre_mm, disc.normal, disc.along),
      Disc{disc.radius_mm, disc.thickness_mm});
}

void SceneBuilder::arrow(const std::string& name, Material material, const Eigen::Vector3d& origin_mm,
                         const Eigen::Vector3d& direction, double length_mm) {
  const double radius_mm = length_mm / 40.0;
  const double head_mm = length_mm / 4.0;
  const Eigen::Vector3d neck = origin_mm + (length_mm - head_mm) * direction;
  cylinder(name, material, origin_mm, neck, radius_mm);
  const Eigen::Vector3d across = Eigen::Vector3d::Unit(std::abs(direction.x()) < 0.9 ? 0 : 1);
  add(name, material, frameAlong(neck, direction, across), Cone{3.2 * radius_mm, head_mm});
}

double beamRadius_mm(const BeamDescription& beam, double distance_mm) {
  const double z = distance_mm / beam.rayleigh_mm;
  return beam.waist_radius_mm * std::sqrt(1.0 + z * z);
}

Scene sceneOf(const MachineDescription& machine, const WebDescription& web, const MachinePose& pose,
              const SceneContent& content) {
  Scene scene;
  scene.machine = machine.name;
  scene.time_s = pose.time_s;
  scene.beam_on = content.beam_on;
  const ConveyorLayout layout = conveyorLayout(machine, web, content);
  const Eigen::Vector2d p_WS_mm(web.start_x_mm + pose.belt_travel_mm + pose.sheet_slip_mm.x(),
                                pose.sheet_slip_mm.y());
  SceneBuilder build(scene);
  addConveyor(build, machine, pose, layout);
  build.on(body_name::kWeb);
  addBoard(build, web, content, layout, p_WS_mm);
  build.on("");
  if (machine.kind == MachineDescription::Kind::kGantry) {
    addGantry(build, machine, pose, layout);
  } else {
    addMirrorHead(build, machine, pose, layout);
  }
  build.on("");
  addScales(build);
  return scene;
}

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include "twin/scene/moving_scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "twin/optics/scan_head.h"
#include "twin/scene/scene_parts.h"

namespace kerfbench::twin {
namespace {

using Kind = SceneJoint::Kind;

SceneJoint slide(const Eigen::Vector3d& axis, PoseColumn by, double scale = 1.0, double wrap_mm = 0.0) {
  return {Kind::kSlide, axis, Eigen::Vector3d::Zero(), by, scale, wrap_mm};
}

SceneJoint turn(const Eigen::Vector3d& axis, const Eigen::Vector3d& origin_mm, PoseColumn by, double scale) {
  return {Kind::kTurn, axis, origin_mm, by, scale, 0.0};
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();

void addConveyorBodies(const MachineDescription& machine, const ConveyorLayout& at,
                       const std::vector<ScenePart>& rest, std::vector<SceneBody>& bodies) {
  const double radius_mm = machine.belt.roller_radius_mm;
  // The roller's height is that of its shaft.
  const auto shaft = std::ranges::find(rest, "roller shaft", &ScenePart::name);
  const double z_mm = shaft->X_WP.translation().z();
  for (const auto& [name, x_mm] :
       {std::pair{body_name::kInfeed, at.min_x_mm}, {body_name::kOutfeed, at.max_x_mm}})
    bodies.push_back({name, -1, {turn(kY, {x_mm, 0.0, z_mm}, PoseColumn::kRoller, 1.0 / radius_mm)}});
  bodies.push_back({body_name::kBeltHoles,
                    -1,
                    {slide(kX, PoseColumn::kBelt, 1.0, at.half_width_mm / kHolesPerHalfWidth)}});
  bodies.push_back(
      {body_name::kWeb,
       -1,
       {slide(kX, PoseColumn::kBelt), slide(kX, PoseColumn::kSlipX), slide(kY, PoseColumn::kSlipY)}});
}

std::vector<SceneJoint> frameJoints() {
  return {slide(kX, PoseColumn::kFrameX), slide(kY, PoseColumn::kFrameY)};
}

void addHeadBodies(const MachineDescription& machine, std::vector<SceneBody>& bodies) {
  const ScanHead optics(machine.head, machine.beam);
  const int head = static_cast<int>(bodies.size());
  bodies.push_back({body_name::kHead, -1, frameJoints()});
  bodies.push_back(
      {body_name::kXMirror,
       head,
       {turn(optics.xMirrorAxis(), optics.xMirrorPlace_mm(), PoseColumn::kMirrorX, machine.head.x.scale)}});
  bodies.push_back(
      {body_name::kYMirror,
       head,
       {turn(optics.yMirrorAxis(), optics.yMirrorPlace_mm(), PoseColumn::kMirrorY, machine.head.y.scale)}});
}

void addGantryBodies(const MachineDescription& machine, std::vector<SceneBody>& bodies) {
  const int bridge = static_cast<int>(bodies.size());
  std::vector<SceneJoint> along = frameJoints();
  along.push_back(slide(kX, PoseColumn::kGantryX));
  bodies.push_back({body_name::kBridge, -1, along});
  // The Y slide is out of square: what rides along it has a share of its way along x.
  const SceneJoint askew = slide(kX, PoseColumn::kGantryY, -machine.squareness_rad);
  bodies.push_back({body_name::kBridgeMirror, bridge, {askew}});
  bodies.push_back({body_name::kCarriage, bridge, {askew, slide(kY, PoseColumn::kGantryY)}});
}

bool isOnBelt(const ScenePart& part) {
  return part.body == body_name::kBeltHoles || part.body == body_name::kWeb;
}

Eigen::Isometry3d displacementOf(const SceneJoint& joint, const MachinePose& pose) {
  double q = joint.scale * poseColumnOf(pose, joint.by);
  if (joint.wrap_mm > 0.0) q -= joint.wrap_mm * std::floor(q / joint.wrap_mm);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (joint.kind == Kind::kSlide) {
    X.translation() = q * joint.axis;
    return X;
  }
  X.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  X.translation() = joint.origin_mm - X.linear() * joint.origin_mm;
  return X;
}

Eigen::Isometry3d bodyAt(const std::vector<Eigen::Isometry3d>& displacements, int body) {
  return body < 0 ? Eigen::Isometry3d::Identity() : displacements[static_cast<std::size_t>(body)];
}

/// A box along W's axes that is cut off at the ends of the belt; nullopt: nothing is left.
std::optional<ScenePart> cutOff(ScenePart part, const BeltEnds& ends) {
  auto& box = std::get<Box>(part.shape);
  const double middle_mm = part.X_WP.translation().x();
  const double low_mm = std::max(ends.min_x_mm, middle_mm - 0.5 * box.size_mm.x());
  const double high_mm = std::min(ends.max_x_mm, middle_mm + 0.5 * box.size_mm.x());
  if (low_mm > high_mm) return std::nullopt;
  box.size_mm.x() = high_mm - low_mm;
  part.X_WP.translation().x() = 0.5 * (low_mm + high_mm);
  return part;
}

}  // namespace

std::string_view poseColumnName(PoseColumn column) {
  constexpr std::array<std::string_view, kPoseColumns> kNames{
      "roller_mm",  "belt_mm",     "slip_x_mm",   "slip_y_mm",    "frame_x_mm",
      "frame_y_mm", "gantry_x_mm", "gantry_y_mm", "mirror_x_rad", "mirror_y_rad"};
  return kNames.at(static_cast<std::size_t>(column));
}

double poseColumnOf(const MachinePose& pose, PoseColumn column) {
  switch (column) {
    case PoseColumn::kRoller:
      return pose.roller_mm;
    case PoseColumn::kBelt:
      return pose.belt_travel_mm;
    case PoseColumn::kSlipX:
      return pose.sheet_slip_mm.x();
    case PoseColumn::kSlipY:
      return pose.sheet_slip_mm.y();
    case PoseColumn::kFrameX:
      return pose.frame_mm.x();
    case PoseColumn::kFrameY:
      return pose.frame_mm.y();
    case PoseColumn::kGantryX:
      return pose.gantry_mm.x();
    case PoseColumn::kGantryY:
      return pose.gantry_mm.y();
    case PoseColumn::kMirrorX:
      return pose.mirror_rad.x();
    case PoseColumn::kMirrorY:
      return pose.mirror_rad.y();
  }
  throw std::logic_error("poseColumnOf: no such column");
}

std::vector<PoseColumn> poseColumnsOf(const MachineDescription& machine) {
  const bool is_gantry = machine.kind == MachineDescription::Kind::kGantry;
  return {PoseColumn::kRoller,
          PoseColumn::kBelt,
          PoseColumn::kSlipX,
          PoseColumn::kSlipY,
          PoseColumn::kFrameX,
          PoseColumn::kFrameY,
          is_gantry ? PoseColumn::kGantryX : PoseColumn::kMirrorX,
          is_gantry ? PoseColumn::kGantryY : PoseColumn::kMirrorY};
}

int MovingScene::bodyNamed(std::string_view name) const {
  if (name.empty()) return -1;
  const auto found = std::ranges::find(bodies, name, &SceneBody::name);
  if (found == bodies.end()) throw std::logic_error("MovingScene: no body " + std::string(name));
  return static_cast<int>(found - bodies.begin());
}

int MovingScene::partNamed(std::string_view name) const {
  const auto found =
      std::ranges::find_if(parts, [&](const MovingPart& moving) { return moving.part.name == name; });
  if (found == parts.end()) throw std::logic_error("MovingScene: no part " + std::string(name));
  return static_cast<int>(found - parts.begin());
}

MovingScene movingScene(const MachineDescription& machine, const WebDescription& web,
                        const SceneContent& content) {
  const bool is_gantry = machine.kind == MachineDescription::Kind::kGantry;
  SceneContent plain;
  plain.unit_S_mm = content.unit_S_mm;
  const Scene rest = sceneOf(machine, web, MachinePose{}, plain);
  const ConveyorLayout layout = conveyorLayout(machine, web, plain);
  MovingScene moving;
  addConveyorBodies(machine, layout, rest.parts, moving.bodies);
  is_gantry ? addGantryBodies(machine, moving.bodies) : addHeadBodies(machine, moving.bodies);
  for (const ScenePart& part : rest.parts)
    if (!isOnBelt(part)) moving.parts.push_back({part, moving.bodyNamed(part.body)});
  addWholeWeb(moving, web, plain, layout);
  is_gantry ? addGantryBeam(moving, machine, layout) : addMirrorBeam(moving, machine);
  moving.overall = {rest.overall};
  moving.head = {rest.head, moving.bodyNamed(is_gantry ? body_name::kCarriage : body_name::kHead),
                 rest.head_view};
  return moving;
}

std::vector<Eigen::Isometry3d> displacementsAt(const MovingScene& moving, const MachinePose& pose) {
  std::vector<Eigen::Isometry3d> displacements;
  for (const SceneBody& body : moving.bodies) {
    Eigen::Isometry3d X = bodyAt(displacements, body.parent);
    for (const SceneJoint& joint : body.joints) X = X * displacementOf(joint, pose);
    displacements.push_back(X);
  }
  return displacements;
}

std::vector<ScenePart> partsAt(const MovingScene& moving, const MachinePose& pose) {
  const std::vector<Eigen::Isometry3d> displacements = displacementsAt(moving, pose);
  std::vector<ScenePart> parts;
  for (const MovingPart& source : moving.parts) {
    const Eigen::Isometry3d X = bodyAt(displacements, source.body);
    for (int copy = 0; copy < source.count; ++copy) {
      const Eigen::Translation3d on(copy * source.step_mm);
      ScenePart part = source.part;
      part.X_WP = X * on * part.X_WP;
      const double x_mm = (X * on * source.shown.point_mm).x();
      const BeltEnds& ends = source.shown.ends;
      switch (source.shown.how) {
        case ShownOnBelt::How::kAlways:
          parts.push_back(std::move(part));
          break;
        case ShownOnBelt::How::kCut:
          if (auto left = cutOff(std::move(part), ends)) parts.push_back(*std::move(left));
          break;
        case ShownOnBelt::How::kWholeWithin:
          if (x_mm >= ends.min_x_mm && x_mm <= ends.max_x_mm) parts.push_back(std::move(part));
          break;
      }
    }
  }
  return parts;
}

std::vector<Eigen::Vector3d> beamAt(const MovingScene& moving, const MachinePose& pose) {
  const std::vector<Eigen::Isometry3d> displacements = displacementsAt(moving, pose);
  std::vector<Eigen::Vector3d> corners;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  const auto meet = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d& from = corners.back();
    corners.push_back(from + (point - from).dot(normal) / direction.dot(normal) * direction);
  };
  for (const BeamCorner& corner : moving.beam) {
    switch (corner.kind) {
      case BeamCorner::Kind::kRides: {
        const Eigen::Isometry3d X = bodyAt(displacements, corner.index);
        corners.push_back(X * corner.p_W_mm);
        direction = X.linear() * corner.direction;
        break;
      }
      case BeamCorner::Kind::kMirror: {
        const MovingPart& mirror = moving.parts[static_cast<std::size_t>(corner.index)];
        const Eigen::Isometry3d X = bodyAt(displacements, mirror.body) * mirror.part.X_WP;
        const Eigen::Vector3d normal = X.linear().col(2);
        meet(X.translation(), normal);
        direction -= 2.0 * direction.dot(normal) * normal;
        break;
      }
      case BeamCorner::Kind::kPlane:
        meet(corner.p_W_mm, corner.direction);
        break;
    }
  }
  return corners;
}

}  // namespace kerfbench::twin

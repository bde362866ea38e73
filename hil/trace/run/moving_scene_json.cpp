// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/moving_scene_json.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

namespace kerfbench::trace {
namespace {

using Json = nlohmann::ordered_json;

Json list(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }
Json list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Json indexOrNull(int index) { return index < 0 ? Json() : Json(index); }

constexpr std::array<std::string_view, 15> kMaterials{"steel",     "aluminium", "paint",  "dark",   "belt",
                                                      "belt_hole", "board",     "print",  "mirror", "glass",
                                                      "tube",      "axis_x",    "axis_y", "axis_z", "light"};

std::string_view nameOf(twin::Material material) { return kMaterials.at(static_cast<std::size_t>(material)); }

Json shapeOf(const twin::ScenePart& part) {
  struct Visitor {
    Json operator()(const twin::Box& box) const {
      return {{"box", {{"size_mm", list(box.size_mm)}, {"edge_radius_mm", box.edge_radius_mm}}}};
    }
    Json operator()(const twin::Cylinder& c) const {
      return {{"cylinder", {{"radius_mm", c.radius_mm}, {"length_mm", c.length_mm}, {"bore_mm", c.bore_mm}}}};
    }
    Json operator()(const twin::Disc& disc) const {
      return {{"disc", {{"radius_mm", list(disc.radius_mm)}, {"thickness_mm", disc.thickness_mm}}}};
    }
    Json operator()(const twin::Cone& cone) const {
      return {{"cone", {{"radius_mm", cone.radius_mm}, {"length_mm", cone.length_mm}}}};
    }
  };
  return std::visit(Visitor{}, part.shape);
}

Json poseOf(const Eigen::Isometry3d& X) {
  const Eigen::Quaterniond q(X.linear());
  const Eigen::Vector3d p = X.translation();
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

Json partOf(const twin::MovingPart& moving) {
  Json part{{"name", moving.part.name},
            {"material", nameOf(moving.part.material)},
            {"body", indexOrNull(moving.body)},
            {"pose", poseOf(moving.part.X_WP)},
            {"shape", shapeOf(moving.part)}};
  if (moving.count > 1) part["repeat"] = {{"count", moving.count}, {"step_mm", list(moving.step_mm)}};
  const Json ends{moving.shown.ends.min_x_mm, moving.shown.ends.max_x_mm};
  if (moving.shown.how == twin::ShownOnBelt::How::kCut) part["clip"] = {{"cut_x_mm", ends}};
  if (moving.shown.how == twin::ShownOnBelt::How::kWholeWithin)
    part["clip"] = {{"within_x_mm", ends}, {"at_mm", list(moving.shown.point_mm)}};
  return part;
}

Json jointOf(const twin::SceneJoint& joint) {
  Json json{{"kind", joint.kind == twin::SceneJoint::Kind::kSlide ? "slide" : "turn"},
            {"axis", list(joint.axis)},
            {"origin_mm", list(joint.origin_mm)},
            {"by", twin::poseColumnName(joint.by)},
            {"scale", joint.scale}};
  if (joint.wrap_mm > 0.0) json["wrap_mm"] = joint.wrap_mm;
  return json;
}

Json cornerOf(const twin::BeamCorner& corner) {
  Json json;
  switch (corner.kind) {
    case twin::BeamCorner::Kind::kRides:
      json = {{"at_mm", list(corner.p_W_mm)}, {"body", indexOrNull(corner.index)}};
      if (!corner.direction.isZero()) json["direction"] = list(corner.direction);
      break;
    case twin::BeamCorner::Kind::kMirror:
      json = {{"mirror", corner.index}};
      break;
    case twin::BeamCorner::Kind::kPlane:
      json = {{"plane", {{"at_mm", list(corner.p_W_mm)}, {"normal", list(corner.direction)}}}};
      break;
  }
  json["radius_mm"] = corner.radius_mm;
  return json;
}

Json viewOf(const twin::SceneBox& box) {
  return {{"min_mm", list(box.box_mm.min())},
          {"max_mm", list(box.box_mm.max())},
          {"body", indexOrNull(box.body)},
          {"look", box.look.isZero() ? Json() : list(box.look)}};
}

Eigen::Vector2d pairFrom(const Json& json) { return {json.at(0).get<double>(), json.at(1).get<double>()}; }
Eigen::Vector3d vectorFrom(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}
int indexFrom(const Json& json) { return json.is_null() ? -1 : json.get<int>(); }

twin::Material materialFrom(const std::string& name) {
  const auto found = std::ranges::find(kMaterials, name);
  if (found == kMaterials.end()) throw std::out_of_range("a part of unknown material " + name);
  return static_cast<twin::Material>(found - kMaterials.begin());
}

twin::PoseColumn columnFrom(const std::string& name) {
  for (std::size_t i = 0; i < twin::kPoseColumns; ++i)
    if (twin::poseColumnName(static_cast<twin::PoseColumn>(i)) == name)
      return static_cast<twin::PoseColumn>(i);
  throw std::out_of_range("a joint of unknown column " + name);
}

std::variant<twin::Box, twin::Cylinder, twin::Disc, twin::Cone> shapeFrom(const Json& shape) {
  if (shape.size() != 1) throw std::out_of_range("a part without a shape");
  const std::string& kind = shape.begin().key();
  const Json& size = shape.begin().value();
  if (kind == "box") return twin::Box{vectorFrom(size.at("size_mm")), size.at("edge_radius_mm")};
  if (kind == "cylinder")
    return twin::Cylinder{size.at("radius_mm"), size.at("length_mm"), size.at("bore_mm")};
  if (kind == "disc") return twin::Disc{pairFrom(size.at("radius_mm")), size.at("thickness_mm")};
  if (kind == "cone") return twin::Cone{size.at("radius_mm"), size.at("length_mm")};
  throw std::out_of_range("a part of unknown shape " + kind);
}

twin::ShownOnBelt shownFrom(const Json& clip) {
  using How = twin::ShownOnBelt::How;
  twin::ShownOnBelt shown;
  shown.how = clip.contains("cut_x_mm") ? How::kCut : How::kWholeWithin;
  const Json& ends = clip.at(shown.how == How::kCut ? "cut_x_mm" : "within_x_mm");
  shown.ends = {ends.at(0), ends.at(1)};
  if (shown.how == How::kWholeWithin) shown.point_mm = vectorFrom(clip.at("at_mm"));
  return shown;
}

twin::MovingPart partFrom(const Json& json) {
  twin::MovingPart moving;
  moving.part.name = json.at("name");
  moving.part.material = materialFrom(json.at("material"));
  const Json& pose = json.at("pose");
  const auto at = [&](std::size_t i) { return pose.at(i).get<double>(); };
  moving.part.X_WP.linear() = Eigen::Quaterniond(at(3), at(4), at(5), at(6)).normalized().toRotationMatrix();
  moving.part.X_WP.translation() = vectorFrom(pose);
  moving.part.shape = shapeFrom(json.at("shape"));
  moving.body = indexFrom(json.at("body"));
  if (json.contains("repeat")) {
    moving.count = json.at("repeat").at("count");
    moving.step_mm = vectorFrom(json.at("repeat").at("step_mm"));
  }
  if (json.contains("clip")) moving.shown = shownFrom(json.at("clip"));
  return moving;
}

twin::SceneBody bodyFrom(const Json& json) {
  twin::SceneBody body;
  body.name = json.at("name");
  body.parent = indexFrom(json.at("parent"));
  for (const Json& joint : json.at("joints")) {
    body.joints.push_back(
        {joint.at("kind") == "slide" ? twin::SceneJoint::Kind::kSlide : twin::SceneJoint::Kind::kTurn,
         vectorFrom(joint.at("axis")), vectorFrom(joint.at("origin_mm")), columnFrom(joint.at("by")),
         joint.at("scale"), joint.value("wrap_mm", 0.0)});
  }
  return body;
}

twin::BeamCorner cornerFrom(const Json& json) {
  twin::BeamCorner corner;
  corner.radius_mm = json.at("radius_mm");
  if (json.contains("mirror")) {
    corner.kind = twin::BeamCorner::Kind::kMirror;
    corner.index = json.at("mirror");
  } else if (json.contains("plane")) {
    corner.kind = twin::BeamCorner::Kind::kPlane;
    corner.p_W_mm = vectorFrom(json.at("plane").at("at_mm"));
    corner.direction = vectorFrom(json.at("plane").at("normal"));
  } else {
    corner.kind = twin::BeamCorner::Kind::kRides;
    corner.p_W_mm = vectorFrom(json.at("at_mm"));
    corner.index = indexFrom(json.at("body"));
    if (json.contains("direction")) corner.direction = vectorFrom(json.at("direction"));
  }
  return corner;
}

twin::SceneBox boxFrom(const Json& json) {
  twin::SceneBox box;
  box.box_mm = Eigen::AlignedBox3d(vectorFrom(json.at("min_mm")), vectorFrom(json.at("max_mm")));
  box.body = indexFrom(json.at("body"));
  if (!json.at("look").is_null()) box.look = vectorFrom(json.at("look"));
  return box;
}

}  // namespace

Json jsonOf(const twin::MovingScene& scene) {
  Json json;
  Json bodies = Json::array();
  for (const twin::SceneBody& body : scene.bodies) {
    Json joints = Json::array();
    for (const twin::SceneJoint& joint : body.joints) joints.push_back(jointOf(joint));
    bodies.push_back({{"name", body.name}, {"parent", indexOrNull(body.parent)}, {"joints", joints}});
  }
  Json parts = Json::array();
  for (const twin::MovingPart& part : scene.parts) parts.push_back(partOf(part));
  Json from = Json::array();
  for (const twin::BeamCorner& corner : scene.beam) from.push_back(cornerOf(corner));
  json["bodies"] = bodies;
  json["parts"] = parts;
  json["beam"] = {{"from", from}, {"spot_radius_mm", scene.spot_radius_mm}};
  json["views"] = {{"overall", viewOf(scene.overall)}, {"head", viewOf(scene.head)}};
  return json;
}

twin::MovingScene movingSceneFrom(const Json& machine) {
  twin::MovingScene scene;
  for (const Json& body : machine.at("bodies")) scene.bodies.push_back(bodyFrom(body));
  for (const Json& part : machine.at("parts")) {
    twin::MovingPart moving = partFrom(part);
    if (moving.body >= 0) moving.part.body = scene.bodies.at(static_cast<std::size_t>(moving.body)).name;
    scene.parts.push_back(std::move(moving));
  }
  for (const Json& corner : machine.at("beam").at("from")) scene.beam.push_back(cornerFrom(corner));
  scene.spot_radius_mm = machine.at("beam").at("spot_radius_mm");
  scene.overall = boxFrom(machine.at("views").at("overall"));
  scene.head = boxFrom(machine.at("views").at("head"));
  return scene;
}

}  // namespace kerfbench::trace

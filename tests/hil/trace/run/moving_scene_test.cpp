// SPDX-License-Identifier: Apache-2.0
// Bodies that joints move, against the scene that the model itself builds at the same pose.
#include "twin/scene/moving_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/machine_file/machine_file.h"
#include "hil/trace/run/moving_scene_json.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance_mm = 1e-9;

/// Machine files of the project, without cameras' calibrations and the catalogue of drives.
std::vector<fs::path> machineFiles() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(base::fixture("machines"))) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".yaml") && !name.ends_with(".camera.yaml") && name != "drivers.yaml")
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// A web of several units whose first eye mark lies beyond the board.
WebDescription severalUnits(const MachineDescription& machine) {
  WebDescription web;
  web.board.thickness_mm = 0.4;
  web.print.units = 7;
  const double side_mm = 0.6 * (machine.controller.field_max_mm[0] - machine.controller.field_min_mm[0]);
  web.print.pitch_mm = 1.2 * side_mm;
  web.print.eye_mark_x_mm = 30.0;
  web.print.marks = {{{-side_mm, -0.4 * side_mm}, 3}, {{-5, 0.4 * side_mm}, 2}};
  web.start_x_mm = -120.5;
  return web;
}

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed, 0) {}
  double within(double size) { return size * (2.0 * random_.uniform(drawn_++) - 1.0); }
  Eigen::Vector2d pair(double size) { return {within(size), within(size)}; }

 private:
  CounterRandom random_;
  std::uint64_t drawn_{0};
};

/// The machine with set-up errors on all that a pose's numbers pass through.
MachineDescription misaligned(MachineDescription machine, Draw& draw) {
  for (MirrorAlignment* mirror : {&machine.head.x, &machine.head.y}) {
    mirror->zero_rad += draw.within(0.02);
    mirror->scale *= 1.0 + draw.within(0.05);
  }
  machine.squareness_rad += draw.within(0.01);
  return machine;
}

MachinePose anyPose(const MachineDescription& machine, Draw& draw) {
  MachinePose pose;
  pose.roller_mm = draw.within(4000.0);
  pose.belt_travel_mm = 500.0 + draw.within(1500.0);
  pose.sheet_slip_mm = draw.pair(3.0);
  pose.frame_mm = draw.pair(0.5);
  if (machine.kind == MachineDescription::Kind::kGantry)
    pose.gantry_mm = draw.pair(300.0);
  else
    pose.mirror_rad = draw.pair(0.12);
  return pose;
}

/// Turns a round part about its own axis as the other is turned: its shape does not tell.
bool isRound(const ScenePart& part) {
  if (const auto* disc = std::get_if<Disc>(&part.shape)) return disc->radius_mm.x() == disc->radius_mm.y();
  return !std::holds_alternative<Box>(part.shape);
}

double sizeOf(const ScenePart& part) {
  struct Visitor {
    double operator()(const Box& box) const { return box.size_mm.norm(); }
    double operator()(const Cylinder& c) const { return std::hypot(2.0 * c.radius_mm, c.length_mm); }
    double operator()(const Disc& disc) const { return 2.0 * disc.radius_mm.maxCoeff(); }
    double operator()(const Cone& cone) const { return std::hypot(2.0 * cone.radius_mm, cone.length_mm); }
  };
  return std::visit(Visitor{}, part.shape);
}

/// Largest distance of a point of the one from where it is on the other.
double apart_mm(const ScenePart& a, const ScenePart& b) {
  const double far_mm = (a.X_WP.translation() - b.X_WP.translation()).norm();
  const Eigen::Matrix3d turned = a.X_WP.linear() - b.X_WP.linear();
  const double angle = isRound(a) ? turned.col(2).norm() : turned.norm();
  double differs_mm = 0.0;
  if (const auto* box = std::get_if<Box>(&a.shape))
    differs_mm = (box->size_mm - std::get<Box>(b.shape).size_mm).norm();
  return far_mm + angle * sizeOf(a) + differs_mm;
}

/// Parts of a name, by place.
std::vector<const ScenePart*> named(const std::vector<ScenePart>& parts, const std::string& name) {
  std::vector<const ScenePart*> some;
  for (const ScenePart& part : parts)
    if (part.name == name) some.push_back(&part);
  return some;
}

void expectSameParts(const std::vector<ScenePart>& moved, const std::vector<ScenePart>& built) {
  EXPECT_EQ(moved.size(), built.size());
  for (const ScenePart& part : built) {
    double least_mm = 1e9;
    for (const ScenePart* other : named(moved, part.name)) {
      if (other->material == part.material && other->shape.index() == part.shape.index())
        least_mm = std::min(least_mm, apart_mm(*other, part));
    }
    EXPECT_LT(least_mm, kTolerance_mm) << part.name << " at " << part.X_WP.translation().transpose();
  }
}

void expectSameBeam(const MovingScene& moving, const MachinePose& pose, const Scene& built) {
  if (built.beam.empty()) return;
  const std::vector<Eigen::Vector3d> corners = beamAt(moving, pose);
  ASSERT_EQ(corners.size() + 1, built.beam.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_LT((corners[i] - built.beam[i].p_W_mm).norm(), kTolerance_mm) << "corner " << i;
}

TEST(MovingScene, IsTheModelsOwnSceneAtAnyPoseOfEveryMachine) {
  const std::vector<fs::path> files = machineFiles();
  ASSERT_GE(files.size(), 20U);
  for (std::size_t file = 0; file < files.size(); ++file) {
    SCOPED_TRACE(files[file].filename().string());
    Draw draw(file);
    const MachineDescription machine = misaligned(machine_file::readMachineFile(files[file]).machine, draw);
    const WebDescription web = severalUnits(machine);
    SceneContent content;
    content.unit_S_mm = Eigen::AlignedBox2d(Eigen::Vector2d(-40, -15), Eigen::Vector2d(0, 15));
    const MovingScene moving = movingScene(machine, web, content);
    for (int i = 0; i < 12; ++i) {
      const MachinePose pose = anyPose(machine, draw);
      const Scene built = sceneOf(machine, web, pose, content);
      expectSameParts(partsAt(moving, pose), built.parts);
      expectSameBeam(moving, pose, built);
    }
  }
}

// The poses above would prove nothing of a mirror that never moves, a web that never ends, a mark that is
// never seen.
TEST(MovingScene, TheProofSeesWhatItIsAbout) {
  std::size_t cut = 0, gone = 0, beams = 0;
  for (const fs::path& file : machineFiles()) {
    Draw draw(7);
    const MachineDescription machine = machine_file::readMachineFile(file).machine;
    const WebDescription web = severalUnits(machine);
    const MovingScene moving = movingScene(machine, web);
    for (int i = 0; i < 12; ++i) {
      const MachinePose pose = anyPose(machine, draw);
      const std::vector<ScenePart> parts = partsAt(moving, pose);
      const auto board = named(parts, "board");
      gone += named(parts, "registration mark").size() < 14 ? 1U : 0U;
      if (!board.empty()) {
        const auto whole =
            std::ranges::find_if(moving.parts, [](const auto& p) { return p.part.name == "board"; });
        cut += std::get<Box>(board.front()->shape).size_mm.x() < std::get<Box>(whole->part.shape).size_mm.x();
      }
      beams += sceneOf(machine, web, pose).beam.empty() ? 0U : 1U;
    }
  }
  EXPECT_GT(cut, 50U);
  EXPECT_GT(gone, 50U);
  EXPECT_GT(beams, 50U);
}

// Films are made of what a trace says of its machine.
TEST(MovingScene, IsTheSameMachineOutOfTheMessageOfATrace) {
  for (const fs::path& file : machineFiles()) {
    SCOPED_TRACE(file.filename().string());
    Draw draw(3);
    const MachineDescription machine = misaligned(machine_file::readMachineFile(file).machine, draw);
    const WebDescription web = severalUnits(machine);
    const MovingScene moving = movingScene(machine, web);
    const MovingScene read =
        trace::movingSceneFrom(nlohmann::ordered_json::parse(trace::jsonOf(moving).dump()));
    const MachinePose pose = anyPose(machine, draw);
    const Scene built = sceneOf(machine, web, pose);
    expectSameParts(partsAt(read, pose), built.parts);
    expectSameBeam(read, pose, built);
    EXPECT_LT((read.head.box_mm.center() - moving.head.box_mm.center()).norm(), kTolerance_mm);
  }
}

TEST(MovingScene, ABodyIsCarriedByABodyBeforeIt) {
  for (const fs::path& file : machineFiles()) {
    const MachineDescription machine = machine_file::readMachineFile(file).machine;
    const MovingScene moving = movingScene(machine, severalUnits(machine));
    for (std::size_t i = 0; i < moving.bodies.size(); ++i) {
      EXPECT_LT(moving.bodies[i].parent, static_cast<int>(i));
      for (const SceneJoint& joint : moving.bodies[i].joints) EXPECT_NEAR(joint.axis.norm(), 1.0, 1e-12);
    }
    for (const MovingPart& part : moving.parts)
      EXPECT_EQ(part.body < 0 ? "" : moving.bodies.at(static_cast<std::size_t>(part.body)).name,
                part.part.body);
  }
}

TEST(MovingScene, ANameThatIsNotThereIsAnError) {
  const MovingScene moving;
  EXPECT_EQ(moving.bodyNamed(""), -1);
  EXPECT_THROW((void)moving.bodyNamed("wheel"), std::logic_error);
  EXPECT_THROW((void)moving.partNamed("wheel"), std::logic_error);
}

}  // namespace
}  // namespace kerfbench::twin

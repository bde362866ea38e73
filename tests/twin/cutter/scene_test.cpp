// SPDX-License-Identifier: Apache-2.0
#include "twin/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

MachineDescription twoMirrors() {
  MachineDescription machine;
  machine.name = "two";
  machine.controller.field_min_mm = {-80, -80};
  machine.controller.field_max_mm = {80, 80};
  machine.belt.print_mark_sensor.x_mm = -150;
  return machine;
}

MachineDescription gantry() {
  MachineDescription machine = twoMirrors();
  machine.kind = MachineDescription::Kind::kGantry;
  machine.belt.roller_radius_mm = 60;
  machine.travel_min_mm = {-40, -430};
  machine.travel_max_mm = {800, 430};
  machine.controller.field_min_mm = {-30, -420};
  machine.controller.field_max_mm = {790, 420};
  return machine;
}

WebDescription labels() {
  WebDescription web;
  web.board.thickness_mm = 0.25;
  web.print.units = 2;
  web.print.pitch_mm = 70;
  web.print.eye_mark_x_mm = 4;
  web.print.marks = {{{-55, -27}, 3}, {{-55, 27}, 3}, {{-5, -27}, 3}, {{-5, 27}, 3}};
  web.start_x_mm = -40;
  return web;
}

std::vector<ScenePart> named(const Scene& scene, const std::string& name) {
  std::vector<ScenePart> parts;
  for (const ScenePart& part : scene.parts) {
    if (part.name == name) parts.push_back(part);
  }
  return parts;
}

Vector3d placeOf(const Scene& scene, const std::string& name) {
  const auto parts = named(scene, name);
  EXPECT_FALSE(parts.empty()) << name;
  return parts.empty() ? Vector3d::Zero() : Vector3d(parts.front().X_WP.translation());
}

void expectNear(const Vector3d& a, const Vector3d& b, double tolerance = 1e-9) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " against " << b.transpose();
}

TEST(Scene, TheSheetAndItsMarksMoveWithTheBeltAndSlipOnIt) {
  MachinePose moved;
  moved.belt_travel_mm = 31.5;
  moved.sheet_slip_mm = {-0.5, 0.25};
  const Scene before = sceneOf(twoMirrors(), labels(), {});
  const Scene after = sceneOf(twoMirrors(), labels(), moved);
  const Vector3d move(31.0, 0.25, 0.0);
  expectNear(placeOf(after, "board") - placeOf(before, "board"), move);
  const auto marks_before = named(before, "registration mark");
  const auto marks_after = named(after, "registration mark");
  ASSERT_EQ(marks_before.size(), 8U);
  ASSERT_EQ(marks_after.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    expectNear(marks_after[i].X_WP.translation() - marks_before[i].X_WP.translation(), move);
  }
  // The place x_W of unit 0's first mark is start + its own place.
  EXPECT_NEAR(marks_before[0].X_WP.translation().x(), -40.0 - 55.0, 1e-12);
  EXPECT_NEAR(marks_before[4].X_WP.translation().x(), -40.0 - 55.0 - 70.0, 1e-12);
}

TEST(Scene, TheBoardLiesBetweenBeltAndWorkPlane) {
  const Scene scene = sceneOf(twoMirrors(), labels(), {});
  const auto board = named(scene, "board");
  ASSERT_EQ(board.size(), 1U);
  const Vector3d size = std::get<Box>(board[0].shape).size_mm;
  EXPECT_NEAR(size.z(), 0.25, 1e-12);
  EXPECT_NEAR(board[0].X_WP.translation().z() + 0.5 * size.z(), 0.0, 1e-12);
  const auto belt = named(scene, "belt");
  ASSERT_FALSE(belt.empty());
  EXPECT_NEAR(belt[0].X_WP.translation().z() + 0.5 * std::get<Box>(belt[0].shape).size_mm.z(), -0.25, 1e-12);
}

TEST(Scene, BoardBeyondTheBeltIsLeftOut) {
  MachinePose gone;
  gone.belt_travel_mm = 1e4;
  const Scene scene = sceneOf(twoMirrors(), labels(), gone);
  EXPECT_TRUE(named(scene, "board").empty());
  EXPECT_TRUE(named(scene, "registration mark").empty());
  EXPECT_TRUE(scene.sheet.isEmpty());
}

TEST(Scene, TheBeltRunsAndItsRollersTurnAsMuch) {
  MachinePose moved;
  moved.belt_travel_mm = 2.0;
  moved.roller_mm = 2.5;  // The belt creeps.
  const Scene before = sceneOf(twoMirrors(), labels(), {});
  const Scene after = sceneOf(twoMirrors(), labels(), moved);
  expectNear(placeOf(after, "belt hole") - placeOf(before, "belt hole"), {2.0, 0.0, 0.0});
  const Vector3d axis = placeOf(before, "roller");
  Vector3d arm_before = placeOf(before, "roller bolt") - axis;
  Vector3d arm_after = placeOf(after, "roller bolt") - axis;
  arm_before.y() = arm_after.y() = 0.0;
  // The top of the roller runs along +Wx.
  EXPECT_GT(arm_after.x(), arm_before.x());
  EXPECT_NEAR(std::acos(arm_before.normalized().dot(arm_after.normalized())), 2.5 / 30.0, 1e-9);
}

TEST(Scene, TheMirrorsStandWhereTheOpticsHaveThem) {
  for (const bool y_first : {false, true}) {
    MachineDescription machine = twoMirrors();
    machine.head.y_mirror_first = y_first;
    MachinePose pose;
    pose.frame_mm = {0.3, -0.2};
    const ScanHead head(machine.head, machine.beam);
    const Scene scene = sceneOf(machine, labels(), pose);
    const Vector3d shift(0.3, -0.2, 0.0);
    expectNear(placeOf(scene, "x mirror"), head.xMirrorPlace_mm() + shift);
    expectNear(placeOf(scene, "y mirror"), head.yMirrorPlace_mm() + shift);
    expectNear(named(scene, "x mirror")[0].X_WP.linear().col(0), head.xMirrorAxis());
    expectNear(named(scene, "y mirror")[0].X_WP.linear().col(0), head.yMirrorAxis());
  }
}

// The spot comes from the optics, the mirrors' faces from the scene: only if both are right the drawn mirrors
// reflect the drawn beam.
TEST(Scene, TheDrawnMirrorsReflectTheDrawnBeam) {
  for (const bool y_first : {false, true}) {
    for (const Vector2d& angles : {Vector2d(0, 0), Vector2d(0.06, -0.03), Vector2d(-0.05, 0.07)}) {
      MachineDescription machine = twoMirrors();
      machine.head.y_mirror_first = y_first;
      MachinePose pose;
      pose.mirror_rad = angles;
      const Scene scene = sceneOf(machine, labels(), pose);
      ASSERT_EQ(scene.beam.size(), 4U);
      for (std::size_t i = 1; i <= 2; ++i) {
        const bool is_x = (i == 1) != y_first;
        const auto mirror = named(scene, is_x ? "x mirror" : "y mirror").at(0);
        const Vector3d normal = mirror.X_WP.linear().col(2);
        const Vector3d in = (scene.beam[i].p_W_mm - scene.beam[i - 1].p_W_mm).normalized();
        const Vector3d out = (scene.beam[i + 1].p_W_mm - scene.beam[i].p_W_mm).normalized();
        expectNear(out, in - 2.0 * in.dot(normal) * normal, 1e-9);
        EXPECT_LT(in.dot(normal), 0.0) << "the beam meets the back of a mirror";
        const Vector3d p = mirror.X_WP.inverse() * scene.beam[i].p_W_mm;
        EXPECT_NEAR(p.z(), 0.0, 1e-9);
        const Vector2d reach = std::get<Disc>(mirror.shape).radius_mm;
        EXPECT_LT(std::hypot(p.x() / reach.x(), p.y() / reach.y()), 1.0) << "beside the mirror";
      }
    }
  }
}

TEST(Scene, TheBeamEndsOnTheBoardWhereChengsFormulaSays) {
  const double a = 0.04;
  const double b = -0.025;
  MachinePose pose;
  pose.mirror_rad = {a, b};
  const Scene scene = sceneOf(twoMirrors(), labels(), pose);
  ASSERT_FALSE(scene.beam.empty());
  const double y = 500.0 * std::tan(2.0 * b);
  const double x = (std::sqrt(500.0 * 500.0 + y * y) + 15.0) * std::tan(2.0 * a);
  expectNear(scene.beam.back().p_W_mm, {x, y, 0.0}, 1e-6);
  // The beam converges all the way to the waist.
  EXPECT_NEAR(scene.beam.back().radius_mm, 0.105, 1e-3);
  EXPECT_GT(scene.beam[2].radius_mm, 1.0);
  EXPECT_GE(scene.beam[1].radius_mm, scene.beam[2].radius_mm);
}

TEST(Scene, ABeamThatMissesIsNotDrawn) {
  MachinePose pose;
  pose.mirror_rad = {0.9, 0.0};
  EXPECT_TRUE(sceneOf(twoMirrors(), labels(), pose).beam.empty());
}

TEST(Scene, ALensStandsInTheBeam) {
  MachineDescription machine = twoMirrors();
  machine.head.lens = LensDescription{};
  machine.head.lens->focal_length_mm = 500.0;
  MachinePose pose;
  pose.mirror_rad = {0.03, 0.02};
  const Scene scene = sceneOf(machine, labels(), pose);
  ASSERT_EQ(scene.beam.size(), 5U);
  const auto lens = named(scene, "f-theta lens");
  ASSERT_FALSE(lens.empty());
  EXPECT_NEAR(scene.beam[3].p_W_mm.z(), lens[0].X_WP.translation().z(), 1e-9);
}

TEST(Scene, TheGantryStandsWhereItsAxesAre) {
  MachineDescription machine = gantry();
  machine.squareness_rad = 0.01;
  MachinePose pose;
  pose.gantry_mm = {300.0, 120.0};
  pose.frame_mm = {0.1, 0.0};
  const Scene at_home = sceneOf(machine, labels(), {});
  const Scene scene = sceneOf(machine, labels(), pose);
  // Gantry y leans towards -x.
  const Vector3d move(300.0 + 0.1 - 0.01 * 120.0, 120.0, 0.0);
  expectNear(placeOf(scene, "carriage mirror") - placeOf(at_home, "carriage mirror"), move);
  expectNear(placeOf(scene, "nozzle") - placeOf(at_home, "nozzle"), move);
  expectNear(placeOf(scene, "bridge") - placeOf(at_home, "bridge"), {300.1, 0.0, 0.0});
  expectNear(placeOf(scene, "gantry rail"), placeOf(at_home, "gantry rail"));
  expectNear(scene.beam.back().p_W_mm, move, 1e-9);
  EXPECT_NEAR(placeOf(at_home, "carriage mirror").x(), 0.0, 1e-12);
  EXPECT_NEAR(placeOf(at_home, "carriage mirror").y(), 0.0, 1e-12);
}

TEST(Scene, TheGantrysMirrorsTurnTheBeamByRightAngles) {
  MachinePose pose;
  pose.gantry_mm = {420.0, -200.0};
  const Scene scene = sceneOf(gantry(), labels(), pose);
  ASSERT_EQ(scene.beam.size(), 5U);
  const std::array<const char*, 3> mirrors{"corner mirror", "bridge mirror", "carriage mirror"};
  for (std::size_t i = 1; i <= 3; ++i) {
    const auto mirror = named(scene, mirrors.at(i - 1)).at(0);
    expectNear(mirror.X_WP.translation(), scene.beam[i].p_W_mm);
    const Vector3d normal = mirror.X_WP.linear().col(2);
    const Vector3d in = (scene.beam[i].p_W_mm - scene.beam[i - 1].p_W_mm).normalized();
    const Vector3d out = (scene.beam[i + 1].p_W_mm - scene.beam[i].p_W_mm).normalized();
    expectNear(out, in - 2.0 * in.dot(normal) * normal);
    EXPECT_NEAR(in.dot(out), 0.0, 1e-9);
  }
}

TEST(Scene, WhatWasBurntMovesWithTheSheetAndEndsWithTheBoard) {
  SceneContent content;
  content.burnt_S_mm = {{{-50, 0}, {-30, 10}, {-10, 0}}, {{-1e4, 0}, {-1.1e4, 0}}};
  MachinePose pose;
  pose.belt_travel_mm = 25.0;
  pose.sheet_slip_mm = {0.0, 1.0};
  const Scene scene = sceneOf(twoMirrors(), labels(), pose, content);
  ASSERT_EQ(scene.burnt.size(), 1U) << "the second path is not on the belt";
  ASSERT_EQ(scene.burnt[0].size(), 3U);
  expectNear(scene.burnt[0][1], {-40.0 + 25.0 - 30.0, 11.0, 0.0});
}

TEST(Scene, EveryPartHasASizeAndAProperPose) {
  for (const MachineDescription& machine : {twoMirrors(), gantry()}) {
    const Scene scene = sceneOf(machine, labels(), {});
    EXPECT_GT(scene.parts.size(), 50U);
    for (const ScenePart& part : scene.parts) {
      EXPECT_NEAR(part.X_WP.linear().determinant(), 1.0, 1e-9) << part.name;
      if (const Box* const box = std::get_if<Box>(&part.shape)) {
        EXPECT_GT(box->size_mm.minCoeff(), 0.0) << part.name;
      } else if (const Cylinder* const cylinder = std::get_if<Cylinder>(&part.shape)) {
        EXPECT_GT(cylinder->length_mm, 0.0) << part.name;
        EXPECT_GT(cylinder->radius_mm, cylinder->bore_mm) << part.name;
      }
    }
    EXPECT_TRUE(scene.overall.contains(scene.sheet)) << machine.name;
    for (const BeamPoint& point : scene.beam) EXPECT_TRUE(point.p_W_mm.allFinite());
  }
}

}  // namespace
}  // namespace kerfbench::twin

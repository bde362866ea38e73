// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "twin/scene/scene.h"

namespace kerfbench::scene {

/// A two-mirror machine with a sheet that has one cut, 120 mm long.
inline twin::Scene sceneWithBeam(bool on) {
  twin::MachineDescription machine;
  machine.name = "two";
  machine.controller.field_min_mm = {-80, -80};
  machine.controller.field_max_mm = {80, 80};
  machine.belt.print_mark_sensor.x_mm = -150;
  twin::MachinePose pose;
  pose.mirror_rad = {0.03, -0.02};
  twin::SceneContent content;
  content.beam_on = on;
  content.unit_S_mm = Eigen::AlignedBox2d(Eigen::Vector2d(-70, -70), Eigen::Vector2d(70, 70));
  content.burnt_S_mm = {{{-60, -40}, {60, -40}}};
  return twin::sceneOf(machine, {}, pose, content);
}

}  // namespace kerfbench::scene

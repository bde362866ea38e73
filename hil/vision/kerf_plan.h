// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf_scan.h"

namespace kerfbench::hil {

/// A place on the dieline where a caliper shall lie.
struct Station {
  double u{};
  double station_mm{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d tangent{Eigen::Vector2d::UnitX()};
  double curvature_per_mm{};
  bool near_joint{};
};

struct EntityPlan {
  int entity{};
  double length_mm{};
  bool closed{};
  std::vector<Station> stations;
};

/// Stations of all entities that are not kIgnore. A station is near a joint where its caliper would also meet
/// another curve, or one meets it at an angle within the clearance; a tangent continuation is no joint.
std::vector<EntityPlan> planStations(const Dieline& dieline, const KerfScanOptions& options);

}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::calibrate {

/// Two places of one thing.
using PlacePair = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

/// Turn and shift that takes the first place of each pair to the second, in the least squares of those that
/// are within ten medians of it: a few false pairs do not matter. At least two pairs.
struct RigidMotion {
  Eigen::Isometry2d X{Eigen::Isometry2d::Identity()};
  double median_miss_mm{};
};
RigidMotion rigidMotion(std::span<const PlacePair> pairs);

}  // namespace kerfbench::calibrate

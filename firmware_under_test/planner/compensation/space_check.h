// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "firmware_under_test/planner/compensation/space_path.h"

namespace kerfbench::planner {

/// A corner of two lines AB, BC with its planes, built from its angles and not by the code under proof.
struct SpaceCorner {
  Eigen::Vector3d a, b, c;
  Eigen::Vector3d n1, n2;
  Eigen::Vector3d along;   ///< Direction of the fold, on the beam's side.
  Eigen::Vector3d h1, h2;  ///< Directions into the half planes.
  Side side{Side::kLeft};

  /// Corner with lines of `length_mm`, turned and moved so that nothing is parallel to an axis.
  static SpaceCorner of(const FoldCorner& angles, double length_mm, Side side);
  [[nodiscard]] SpaceContour contour() const;
};

/// Check of a path round a corner by samples; distances in space. The check is independent of how the path
/// was made.
struct SpaceCheck {
  std::size_t samples{};
  double nearest_mm{};      ///< Least distance of the path from AB and BC.
  double missed_mm{};       ///< Largest distance from the path of a strict offset's point that is free.
  double off_surface_mm{};  ///< Largest distance of the path from the half plane that its axis stands upon.
};

/// Checks a path. `radius_mm` sets the samples' distance: a fiftieth of it up to 20 radii from B, one radius
/// beyond.
SpaceCheck checkCorner(const SpaceCorner& corner, const std::vector<SpacePoint>& path, double radius_mm);

/// Checks the joint `report` of a path: its lines from where the joint before ends to where the next begins.
SpaceCheck checkJoint(const SpaceContour& contour, const SpacePath& path, const SpaceJointReport& report,
                      double radius_mm);

}  // namespace kerfbench::planner

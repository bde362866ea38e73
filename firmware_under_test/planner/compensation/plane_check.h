// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "firmware_under_test/planner/compensation/contour.h"

namespace kerfbench::planner {

/// Check of a beam path by samples. It shares nothing with offsetContours() but the Segment: contours and
/// paths become chords no more than 4e-6 mm off their curves, and distances are those between points and
/// chords. So it cannot distinguish the sides of a wedge where they are no farther apart than that: it may
/// report a place as missed at the very tip of a cusp.
struct PlaneCheck {
  std::size_t samples{};
  double nearest_mm{};   ///< Least distance of a path from a contour.
  double farthest_mm{};  ///< Largest distance of a path from the contours.
  /// Largest distance from the path of any point that a strict offset has, and at which a beam 2 % wider
  /// would touch the contour at one place only: 0 for a path that is exact wherever it can be.
  double missed_mm{};
  bool right_side{true};  ///< True if all of the path is on the beam's side (closed contours).
  /// True if paths of closed contours are closed, and all are without gaps beyond 1e-4 mm.
  bool whole{true};

  [[nodiscard]] bool holds(double radius_mm) const;
};

PlaneCheck checkPlane(const std::vector<Contour>& contours, const std::vector<std::vector<Segment>>& paths,
                      double radius_mm);

}  // namespace kerfbench::planner

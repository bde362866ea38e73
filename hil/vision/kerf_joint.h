// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf_plan.h"
#include "hil/vision/kerf_tiles.h"

namespace kerfbench::hil {

/// What corners and ends are measured in.
struct JointScene {
  const TileIndex* tiles{};
  const CameraCalibration* calibration{};
  const PlaneMotion* X_TS{};
  const KerfScanOptions* options{};
  const KerfPlan* plan{};
  const std::vector<EntityKerf>* kerfs{};  ///< Of the unit, in the plan's order.
  int unit{};
};

/// The corner as cut, seen along its bisector from outside and along both legs, from where the legs as cut
/// would meet. The kerf's centre line lies half a kerf inside its outline; KerfOutline tells what a perfect
/// corner would show.
CornerKerf measureCorner(const JointScene& scene, const PlannedCorner& corner);

/// Where a kerf ends, from the outline beyond it along the curve.
LineEnd measureEnd(const JointScene& scene, const EntityEnd& end);

/// The gap between start and end of a closed curve, from the light along it: 0 where it is closed.
LineEnd measureClosure(const JointScene& scene, const EntityEnd& start);

}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/corner/corner_fit.h"
#include "hil/vision/corner/joint_scene.h"
#include "hil/vision/kerf/kerf_leg.h"

namespace kerfbench::vision {

/// Distance from the corner from which on calipers measure a leg, mm.
inline constexpr double kLegFromMm = 0.3;

/// Length of each leg in the picture of a corner.
inline constexpr double kCornerLegMm = 0.65;

/// A leg on its nominal curve.
CornerLeg nominalLeg(const JointScene& scene, const EntityEnd& end);

/// Length of a leg that is looked at: a short entity has its next joint there.
double lookedAtMm(const JointScene& scene, const EntityEnd& end);

/// Leg by its calipers: where it lies near the corner; where it would if an arc that cuts the corner from
/// afar had them follow it; and their readings, which know of scorch.
struct LegGuess {
  CornerLeg near, far;
  KnownLeg known;
};

/// `measured` places the leg where calipers are too few for more.
LegGuess followCalipers(const JointScene& scene, const EntityEnd& end, const KerfLeg& measured);

}  // namespace kerfbench::vision

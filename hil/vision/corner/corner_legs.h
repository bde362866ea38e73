// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/corner/corner_fit.h"
#include "hil/vision/corner/joint_scene.h"
#include "hil/vision/kerf/kerf_leg.h"

namespace kerfbench::vision {

/// From here on, measured from the corner, calipers tell where a leg lies, mm.
inline constexpr double kLegFromMm = 0.3;

/// How much of each leg the picture of a corner holds.
inline constexpr double kCornerLegMm = 0.65;

/// A leg on its nominal curve.
CornerLeg nominalLeg(const JointScene& scene, const EntityEnd& end);

/// How much of a leg is looked at: a short entity has its next joint there.
double lookedAtMm(const JointScene& scene, const EntityEnd& end);

/// What calipers tell of a leg: where it lies near the corner; where it would if an arc that cuts the corner
/// from afar had them follow it; and their readings, which know of scorch.
struct LegGuess {
  CornerLeg near, far;
  KnownLeg known;
};

/// `measured` tells where the leg lies if calipers are too few for more.
LegGuess followCalipers(const JointScene& scene, const EntityEnd& end, const KerfLeg& measured);

}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/corner_fit.h"
#include "hil/vision/joint_scene.h"
#include "hil/vision/kerf_leg.h"

namespace kerfbench::hil {

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

}  // namespace kerfbench::hil

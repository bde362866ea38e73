// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/corner/joint_scene.h"

namespace kerfbench::vision {

/// The corner as cut, from all pixels around it: both legs up to where calipers measure them alone, and how
/// they meet. A model of the kerf's picture is fitted to them (corner_fit.h); its path is compared with the
/// nominal one.
CornerKerf measureCorner(const JointScene& scene, const PlannedCorner& corner);

}  // namespace kerfbench::vision

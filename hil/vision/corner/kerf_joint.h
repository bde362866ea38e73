// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/vision/corner/joint_scene.h"

namespace kerfbench::vision {

/// End of a kerf, from the outline beyond it along the curve.
LineEnd measureEnd(const JointScene& scene, const EntityEnd& end);

/// The gap between start and end of a closed curve, from the light along it: 0 where it is closed.
LineEnd measureClosure(const JointScene& scene, const EntityEnd& start);

}  // namespace kerfbench::vision

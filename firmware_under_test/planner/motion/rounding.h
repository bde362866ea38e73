// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {

/// Path whose corners between marks of one Z are rounded where the beam gets round them faster so: two arcs,
/// tangent to both legs, take the place of the last d of one leg and the first d of the next, at most half of
/// either. Between two lines that turn by t their radius is d / tan(t/2), and they pass the corner at
/// d tan(t/4).
///
/// That distance and what drives that lag by tau and chords over periods T add on the arcs,
/// v²/R (tau²/4 + T²/8), stay together within corners.error_mm times cos(t): from a right angle on a corner
/// stays sharp. No corner is rounded more than the top speed asks for. Many short lines along a curve so
/// become about that curve, however many they are.
std::vector<Segment> roundedCorners(const std::vector<Segment>& path, const FlowLimits& limits);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "hil/camera/v4l2/camera_clock.h"
#include "hil/camera/v4l2/light_profile.h"

namespace kerfbench::camera {

/// Interval in which the light may have been on, by the pins.
struct LightInterval {
  double on_s{};
  double off_s{};
};

/// Relates a camera's clock to that of the pins by a light that the pins switch, though nothing is known
/// beforehand of how the clocks lie to each other. `frames` and `intervals` by time, and intervals apart;
/// `profile` may be null; `period_s`: from frame to frame, about.
///
/// First, which frame shows which interval: each begin of an interval is tried for each of the first begins
/// of light, and what explains lit frames and intervals best is taken, if nothing else explains them nearly
/// as well. Intervals all alike and evenly spaced, of which the camera saw but a part, have no answer.
///
/// Then bounds: a lit frame overlaps one of the intervals that it can overlap by what is known so far. That
/// narrows what is known, so again, until it narrows no more. A light may begin and end softly (a laser whose
/// power follows the speed): that a frame is dark says nothing, unless options.is_light_hard. Then a dark
/// frame next to a lit one had none, and the first and last lit ones their share of it.
///
/// Last, if a profile is given, sharpened() makes of it what it can. What is late in all intervals alike (a
/// tube's delay) is taken for the clock's offset.
CameraClockFit fitLightClock(std::span<const FrameLight> frames, std::span<const LightInterval> intervals,
                             const LightProfile* profile, double period_s, const CameraClockOptions& options);

}  // namespace kerfbench::camera

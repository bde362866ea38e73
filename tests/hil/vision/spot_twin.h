// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "hil/vision/spot/spot_track.h"
#include "twin/camera/camera.h"

namespace kerfbench::vision::test {

/// A spot camera of 0.1 mm to the pixel, askew and with a lens.
twin::CameraDescription spotCamera(int width_px = 320, int height_px = 256);

/// Grey levels per watt at the centre of a resting spot, with spotCamera().
constexpr double kGlowGrayPerW = 4.0;
constexpr double kSpotRadiusMm = 0.105;

/// Exposure of a spot that runs evenly along `streak_mm` around its middle; power for `gray` at rest.
twin::Exposure exposureOf(std::uint64_t sequence, const Eigen::Vector2d& middle_mm,
                          const Eigen::Vector2d& streak_mm, double gray);

PrintLayout noPrint();

/// Track that the bench makes of frames of the model.
SpotTrack trackOf(const twin::CameraDescription& camera, const PrintLayout& print, std::vector<Frame> frames,
                  double speed_mm_s = 0.0);

}  // namespace kerfbench::vision::test

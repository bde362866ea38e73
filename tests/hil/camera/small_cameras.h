// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "twin/camera/camera.h"

namespace kerfbench::camera {

/// A camera that looks straight down from 300 mm; x along the plane's x, y against it.
inline twin::CameraDescription smallCamera(int width_px, int height_px, double mm_per_px) {
  twin::CameraDescription camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = camera.fy_px = 300.0 / mm_per_px;
  camera.cx_px = 0.5 * (width_px - 1);
  camera.cy_px = 0.5 * (height_px - 1);
  camera.distortion = {-0.1, 0.0, 0.0, 0.0, 0.0};
  camera.X_CP =
      Eigen::Translation3d(0.0, 0.0, 300.0) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  return camera;
}

}  // namespace kerfbench::camera

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "twin/base/image.h"
#include "twin/camera/camera.h"

namespace kerfbench::twin {

/// A camera above the plane, a little askew, with a noticeable distortion. Its x runs along the plane's x, y
/// against it.
inline CameraDescription cameraAbove(int width_px, int height_px, double mm_per_px, double tilt_rad = 0.07) {
  CameraDescription camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  const double height_mm = 500.0;
  camera.fx_px = height_mm / mm_per_px;
  camera.fy_px = 1.002 * camera.fx_px;
  camera.cx_px = 0.5 * width_px + 3.7;
  camera.cy_px = 0.5 * height_px - 5.2;
  camera.distortion = {-0.15, 0.05, 2e-4, -3e-4, 0.01};
  const Eigen::Vector3d tilt_axis = Eigen::Vector3d(1.0, 0.4, 0.2).normalized();
  camera.X_CP = Eigen::Translation3d(0.0, 0.0, height_mm) * Eigen::AngleAxisd(tilt_rad, tilt_axis) *
                Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  return camera;
}

inline CameraDescription withoutNoise(CameraDescription camera) {
  camera.read_noise = 0.0;
  camera.full_well_electrons = std::numeric_limits<double>::infinity();
  return camera;
}

/// Board so thin that it looks the same from all sides.
inline BoardDescription thinBoard() {
  BoardDescription board;
  board.thickness_mm = 1e-6;
  return board;
}

/// Centroid and sum of |gray - base| in the square of half side `half` around a pixel.
struct Centroid {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  double sum{};
};
inline Centroid centroidAround(const GrayImage& image, const Eigen::Vector2d& around_px, int half,
                               double base) {
  Centroid found;
  const int x0 = static_cast<int>(std::lround(around_px.x()));
  const int y0 = static_cast<int>(std::lround(around_px.y()));
  for (int y = y0 - half; y <= y0 + half; ++y) {
    for (int x = x0 - half; x <= x0 + half; ++x) {
      const double weight = std::abs(image.at(x, y) - base);
      found.sum += weight;
      found.pixel += weight * Eigen::Vector2d(x, y);
    }
  }
  found.pixel /= found.sum;
  return found;
}

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "hil/calibrate/camera/calibrate_camera.h"
#include "hil/camera/twin/views/twin_views.h"
#include "twin/camera/camera.h"

namespace kerfbench::calibrate::test {

/// A camera of few pixels, with a noticeable lens, that looks askew at its plane.
inline twin::CameraDescription smallCamera() {
  twin::CameraDescription camera;
  camera.width_px = 560;
  camera.height_px = 440;
  camera.fx_px = 2500.0;
  camera.fy_px = 2505.0;
  camera.cx_px = 285.0;
  camera.cy_px = 214.0;
  camera.distortion = {-0.12, 0.05, 2e-4, -3e-4, 0.0};
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 0.4, 0.2).normalized();
  camera.X_CP = Eigen::Translation3d(3.0, -2.0, 250.0) * Eigen::AngleAxisd(0.06, axis) *
                Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  return camera;
}

/// Result of a perfect calibration.
inline vision::CameraCalibration truthOf(const twin::CameraDescription& camera) {
  vision::CameraCalibration truth;
  truth.width_px = camera.width_px;
  truth.height_px = camera.height_px;
  truth.fx_px = camera.fx_px;
  truth.fy_px = camera.fy_px;
  truth.cx_px = camera.cx_px;
  truth.cy_px = camera.cy_px;
  truth.distortion = camera.distortion;
  truth.telecentric_mm = camera.telecentric_mm;
  truth.X_CP = camera.X_CP;
  return truth;
}

/// Errors of a calibration at points of its area, x and y of each; only points that the camera sees.
inline std::vector<Eigen::Vector2d> mapErrors(const vision::CameraCalibration& calibration,
                                              const vision::CameraCalibration& truth, int grid,
                                              std::vector<Eigen::Vector2d>* places_mm = nullptr) {
  std::vector<Eigen::Vector2d> errors_mm;
  for (int i = 0; i <= grid; ++i) {
    for (int j = 0; j <= grid; ++j) {
      const Eigen::Array2d share(static_cast<double>(i) / grid, static_cast<double>(j) / grid);
      const Eigen::Vector2d p_mm =
          calibration.area_mm.min().array() + share * calibration.area_mm.sizes().array();
      const auto pixel = truth.pixelIfSeen(p_mm, 0.0);
      if (!pixel) continue;
      errors_mm.emplace_back(calibration.planeFromPixel(*pixel) - p_mm);
      if (places_mm != nullptr) places_mm->push_back(p_mm);
    }
  }
  return errors_mm;
}

inline double largest(const std::vector<Eigen::Vector2d>& vectors) {
  double most = vectors.empty() ? std::nan("") : 0.0;
  for (const Eigen::Vector2d& v : vectors) most = std::max(most, v.norm());
  return most;
}

/// Views of the small camera, by this seed.
inline CalibrationJob smallJob(std::uint64_t seed, int tilted = 5) {
  const twin::CameraDescription camera = smallCamera();
  CalibrationJob job;
  camera::setTwinViews(camera, camera::twinViews(camera, camera::targetOf(camera), tilted), seed, job);
  job.camera_id = "small";
  job.date = "2026-11-20";
  return job;
}

}  // namespace kerfbench::calibrate::test

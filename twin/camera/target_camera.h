// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "twin/camera/camera.h"
#include "twin/camera/picture_shading.h"
#include "twin/camera/sensor_noise.h"
#include "twin/camera/target_board.h"

namespace kerfbench::twin {

/// Renders views of a calibration target by a camera of the model: its lens, blur, uneven light, hot pixels,
/// noise and depth. The projection of the target by the lens is computed for each pixel, not sampled: edges
/// and corners are in place to 1e-4 px.
///
/// Noise is sampled from seed and `view`, so views can be rendered alone, in any order, from any thread.
/// Immutable.
class TargetCamera {
 public:
  /// Makes the camera; `camera.X_CP` is ignored. @throws std::invalid_argument that names everything wrong.
  TargetCamera(const CameraDescription& camera, const TargetBoard& board, std::uint64_t seed);

  /// Picture of the board. X_CB: its pose in the camera. @throws std::invalid_argument for a pose that is not
  /// rigid and finite or a board that shows its back, as one behind the camera does.
  [[nodiscard]] GrayImage render(const Eigen::Isometry3d& X_CB, std::uint64_t view) const;
  [[nodiscard]] const CameraDescription& description() const { return camera_; }

 private:
  CameraDescription camera_;
  TargetPattern pattern_;
  PictureShading shading_;
  SensorNoise noise_;
  std::uint64_t seed_;
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/base/image.h"
#include "twin/base/print_layout.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// A camera of the model: pinhole with distortion (k1 k2 p1 p2 k3), blur and noise. X_CP is the pose in the camera of
/// the plane it looks at: work plane W for the spot camera, inspection table for the kerf camera. z of the camera
/// points at the plane.
struct CameraDescription {
  int width_px{};
  int height_px{};
  double fx_px{}, fy_px{}, cx_px{}, cy_px{};
  std::array<double, 5> distortion{};
  Eigen::Isometry3d X_CP{Eigen::Isometry3d::Identity()};
  double psf_sigma_px{0.6};
  double read_noise{0.8};          ///< Grey levels, standard deviation.
  double full_well_electrons{10000};  ///< At grey level 255: sets the shot noise.
  double board_gray{110};          ///< Board under this camera's light (spot camera), or the back light through an open kerf is 235.
  double frame_period_s{0.001};    ///< Spot camera only.
  double exposure_s{50e-6};
};

/// What the spot camera needs to know of one exposure: states at a few instants inside it, evenly spaced.
struct ExposureSample {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};  ///< Spot.
  double radius_mm{};
  double power_w{};
  Eigen::Vector2d p_WS_mm{Eigen::Vector2d::Zero()};  ///< Origin of the web's S (unit 0) in W.
  double angle_rad{};                                ///< Of the web.
};
struct Exposure {
  std::uint64_t sequence{};
  double start_s{};
  std::vector<ExposureSample> samples;  ///< >= 1
};

/// Renders what the spot camera sees: board, printed marks of every unit in view, the glowing spot smeared over the
/// exposure, blur, shot and read noise (drawn from seed and sequence: any frame can be rendered alone, in any order,
/// from any thread).
class SpotCamera {
 public:
  SpotCamera(const CameraDescription& camera, const PrintLayout& print, double glow_gray_per_w, std::uint64_t seed);
  [[nodiscard]] Frame render(const Exposure& exposure) const;
};

/// Renders back-lit tiles of one unit laid on the inspection table.
class KerfCamera {
 public:
  KerfCamera(const CameraDescription& camera, const PrintLayout& print, std::uint64_t seed);

  /// p_TV_mm: shift of the camera over the table. X_TS: how the unit's frame S_k lies on the table.
  [[nodiscard]] GrayImage render(const Sheet& sheet, int unit, const Eigen::Vector2d& p_TV_mm,
                                 const Eigen::Isometry2d& X_TS) const;
};

}  // namespace kerfbench::twin

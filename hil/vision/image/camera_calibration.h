// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::vision {

/// First-order map of the plane around one of its points: pixel + pixel_per_mm * (p - p0).
struct LocalPixelMap {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d pixel_per_mm{Eigen::Matrix2d::Identity()};

  /// Side of a square of 1 mm² in the picture, px.
  [[nodiscard]] double pxPerMm() const;
};

/// A calibrated camera above a plane (OpenCV's model and order of distortion coefficients). Frame P is the
/// plane that it looks at, z = 0 on the board: the work plane W of the spot camera; for the kerf camera the
/// inspection table T, at the height of the sheet's printed face.
struct CameraCalibration {
  int width_px{};
  int height_px{};
  double fx_px{}, fy_px{}, cx_px{}, cy_px{};
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
  /// 0: entocentric, a pinhole. Else telecentric: lines of sight are parallel, and x and y in the camera,
  /// divided by this length, take the place of x/z and y/z.
  double telecentric_mm{};
  /// Telecentric: bound (95 %) of the angle by which the lines of sight are not square to the plane; its
  /// direction is not known.
  double square_within_rad{};
  Eigen::Isometry3d X_CP{Eigen::Isometry3d::Identity()};  ///< Pose of the plane in the camera; lengths in mm.
  double map_u_mm{};  ///< Standard uncertainty of a mapped point within the board area of the calibration.

  std::string camera_id{};  ///< Serial number or name; pictures of another camera must not be read with this.
  std::string date{};       ///< ISO 8601 day of the views, "2026-11-21".
  double rms_px{};          ///< Reprojection residual of all corners, per axis.
  Eigen::AlignedBox2d
      area_mm{};  ///< Area of plane P that the target covered: outside, map_u_mm says nothing.
  /// Error modes of the map: their sum, weighted by independent standard normal values, has the covariance of
  /// the parameters of planeFromPixel. Order of the parameters: fx fy cx cy, k1 k2 p1 p2 k3, rotation vector
  /// of the plane (rad, left-multiplied), its translation (mm).
  static constexpr int kParameters = 15;
  std::vector<Eigen::Matrix<double, kParameters, 1>> error_modes{};
  /// Shift of the point of the plane seen at p_mm for one standard deviation of error mode k, mm.
  [[nodiscard]] Eigen::Vector2d mapError(std::size_t mode, const Eigen::Vector2d& p_mm) const;

  /// Pixel to the point of the plane z = 0. @throws std::domain_error for a ray that misses the plane.
  [[nodiscard]] Eigen::Vector2d planeFromPixel(const Eigen::Vector2d& pixel) const;
  /// Point of the plane to its pixel, in the image or not. @throws std::domain_error behind the camera.
  [[nodiscard]] Eigen::Vector2d pixelFromPlane(const Eigen::Vector2d& p_mm) const;
  /// Point of the plane to its pixel, with the Jacobian. @throws std::domain_error behind the camera.
  [[nodiscard]] LocalPixelMap localMap(const Eigen::Vector2d& p_mm) const;
  /// The pixel, if it lies in the image at least border_px away from its edge. Points so far out that the
  /// lens polynomial folds them back into the picture are not seen.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixelIfSeen(const Eigen::Vector2d& p_mm,
                                                           double border_px) const;
  /// Many pixels at once, without repeating the set-up. @throws std::invalid_argument for unequal sizes.
  void planeFromPixels(std::span<const Eigen::Vector2d> pixels, std::span<Eigen::Vector2d> p_mm) const;
  /// How far a line of sight that meets the plane at p_mm moves on per millimetre below it: outwards from the
  /// foot of a pinhole. Zero for a telecentric lens: what it is not square by is in square_within_rad.
  [[nodiscard]] Eigen::Vector2d sightSlope(const Eigen::Vector2d& p_mm) const;
  /// The same camera over the plane that lies depth_mm below, farther from it. Frames lie square below each
  /// other. A telecentric lens shows all planes alike, as sightSlope() has it.
  [[nodiscard]] CameraCalibration lowered(double depth_mm) const;
  /// Mean scale at the image centre, mm per pixel.
  [[nodiscard]] double pitchMm() const;
};

}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::calibrate {

/// A corner of a flat target and where a view has it.
struct BundlePoint {
  Eigen::Vector2d p_B_mm;
  Eigen::Vector2d pixel;
  Eigen::Matrix2d covariance_px2{
      Eigen::Matrix2d::Identity()};  ///< Covariance of the pixel, up to a factor of the view.
};

/// Lens as in CameraCalibration: fx fy cx cy, k1 k2 p1 p2 k3.
struct BundleLens {
  Eigen::Vector4d pinhole{Eigen::Vector4d::Zero()};
  std::array<double, 5> distortion{};
  double telecentric_mm{};  ///< As CameraCalibration's; 0: a pinhole. Not adjusted.
};

struct Bundle {
  BundleLens lens;
  std::vector<Eigen::Isometry3d> X_CB;           ///< Pose of the target in the camera, for each view.
  std::vector<std::vector<BundlePoint>> points;  ///< Points of each view.
};

struct BundleResult {
  BundleLens lens;
  std::vector<Eigen::Isometry3d> X_CB;
  std::vector<std::vector<Eigen::Vector2d>> residuals_px;  ///< Seen less modelled, of each point.
  std::vector<double> sigma_px;                            ///< RMS of the residuals of each view, per axis.
  double rms_px{};                                         ///< RMS of all residuals, per axis.
  bool settled{};
  /// Covariance of lens (9) and each view's pose (6: rotation vector, left-multiplied, rad; translation, mm),
  /// in this order. Not finite where the views do not fix all of it.
  Eigen::MatrixXd covariance;
};

/// Least squares over lens and all poses at once: Levenberg and Marquardt from the start given. Corners are
/// weighted by their covariances, and each view's covariances are scaled to its own scatter, found on the
/// way; the covariance is the inverse of the weighted normal matrix (JCGM 102), so it holds for noise that is
/// independent from corner to corner.
///
/// Views by a telecentric lens do not tell all of this: not how far the target is, nor where the axis of the
/// lens is but by its distortion, and how the first view is tilted only by the square of the angle. So the
/// start counts as a measurement of these, of standard deviation 1 mm, 1 % of the focal length and, of a
/// first view square to the axis, 1°.
/// @throws std::invalid_argument for no views, unequal sizes or a view without points.
BundleResult adjust(const Bundle& start);

/// Pixel of a point of the target by this lens and pose. The point must lie before the camera.
Eigen::Vector2d project(const BundleLens& lens, const Eigen::Isometry3d& X_CB, const Eigen::Vector2d& p_B_mm);

/// The pixel's derivatives by lens (9) and pose (6), in BundleResult's order.
using ProjectionSlopes = Eigen::Matrix<double, 2, 15>;
Eigen::Vector2d project(const BundleLens& lens, const Eigen::Isometry3d& X_CB, const Eigen::Vector2d& p_B_mm,
                        ProjectionSlopes& by);

}  // namespace kerfbench::calibrate

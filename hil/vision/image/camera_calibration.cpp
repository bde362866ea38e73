// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/image/camera_calibration.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include "hil/vision/image/lens_distortion.h"

namespace kerfbench::vision {
namespace {

/// Newton's method; OpenCV's own fixed point needs dozens of rounds for the same digits.
Eigen::Vector2d undistort(const std::array<double, 5>& d, const Eigen::Vector2d& distorted) {
  constexpr int kMaxRounds = 40;
  Eigen::Vector2d n = distorted;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Distorted at = distort(d, n);
    const double det = at.jacobian.determinant();
    if (!(det > 1e-6)) break;
    const Eigen::Vector2d step = at.jacobian.inverse() * (at.point - distorted);
    n -= step;
    if (step.squaredNorm() < 1e-30 * (1.0 + n.squaredNorm())) return n;
    // Rounding may keep the last bit of the step alive; what is left is far below any pixel.
    if (round > 8 && step.squaredNorm() < 1e-24) return n;
  }
  throw std::domain_error("camera calibration: the pixel lies beyond the fold of the lens distortion");
}

/// Columns: the plane's x and y axes and its origin, in the camera.
Eigen::Matrix3d planeToCamera(const Eigen::Isometry3d& X_CP) {
  Eigen::Matrix3d h;
  h << X_CP.linear().col(0), X_CP.linear().col(1), X_CP.translation();
  return h;
}

/// Point of the plane on the line of sight of a normalised pixel.
Eigen::Vector2d intersect(const Eigen::Matrix3d& camera_to_plane, const Eigen::Vector2d& normalised) {
  const Eigen::Vector3d q = camera_to_plane * normalised.homogeneous();
  // 1 / q.z is the depth of the point in front of the camera.
  if (!(q.z() > 1e-12)) throw std::domain_error("camera calibration: the ray of the pixel misses the plane");
  return q.head<2>() / q.z();
}

/// The same for lines of sight along the camera's z.
Eigen::Vector2d intersectTelecentric(const CameraCalibration& c, const Eigen::Vector2d& normalised) {
  const Eigen::Matrix2d axes = c.X_CP.linear().topLeftCorner<2, 2>();
  return axes.inverse() * (c.telecentric_mm * normalised - c.X_CP.translation().head<2>());
}

Eigen::Vector3d inCamera(const Eigen::Isometry3d& X_CP, const Eigen::Vector2d& p_mm) {
  const Eigen::Vector3d c = X_CP * Eigen::Vector3d(p_mm.x(), p_mm.y(), 0.0);
  if (!(c.z() > 0.0)) throw std::domain_error("camera calibration: the point lies behind the camera");
  return c;
}

/// What x and y of a point in the camera are divided by.
double scaleDepth(const CameraCalibration& c, const Eigen::Vector3d& p_C_mm) {
  return c.telecentric_mm > 0.0 ? c.telecentric_mm : p_C_mm.z();
}

}  // namespace

double LocalPixelMap::pxPerMm() const { return std::sqrt(std::abs(pixel_per_mm.determinant())); }

Eigen::Vector2d CameraCalibration::planeFromPixel(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d p_mm;
  planeFromPixels({&pixel, 1}, {&p_mm, 1});
  return p_mm;
}

void CameraCalibration::planeFromPixels(std::span<const Eigen::Vector2d> pixels,
                                        std::span<Eigen::Vector2d> p_mm) const {
  if (pixels.size() != p_mm.size()) {
    throw std::invalid_argument("camera calibration: as many results as pixels are needed");
  }
  const Eigen::Matrix3d camera_to_plane = planeToCamera(X_CP).inverse();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector2d distorted((pixels[i].x() - cx_px) / fx_px, (pixels[i].y() - cy_px) / fy_px);
    const Eigen::Vector2d normalised = undistort(distortion, distorted);
    p_mm[i] = telecentric_mm > 0.0 ? intersectTelecentric(*this, normalised)
                                   : intersect(camera_to_plane, normalised);
  }
}

Eigen::Vector2d CameraCalibration::mapError(std::size_t mode, const Eigen::Vector2d& p_mm) const {
  const Eigen::Matrix<double, kParameters, 1>& e = error_modes.at(mode);
  CameraCalibration other = *this;
  other.fx_px += e[0];
  other.fy_px += e[1];
  other.cx_px += e[2];
  other.cy_px += e[3];
  for (Eigen::Index i = 0; i < 5; ++i) other.distortion.at(static_cast<std::size_t>(i)) += e[4 + i];
  const Eigen::Vector3d turn = e.segment<3>(9);
  const double angle_rad = turn.norm();
  if (angle_rad > 0.0) {
    other.X_CP.linear() =
        Eigen::AngleAxisd(angle_rad, turn / angle_rad).toRotationMatrix() * other.X_CP.linear();
  }
  other.X_CP.translation() += e.tail<3>();
  return other.planeFromPixel(pixelFromPlane(p_mm)) - p_mm;
}

Eigen::Vector2d CameraCalibration::pixelFromPlane(const Eigen::Vector2d& p_mm) const {
  const Eigen::Vector3d c = inCamera(X_CP, p_mm);
  const Eigen::Vector2d d = distort(distortion, c.head<2>() / scaleDepth(*this, c)).point;
  return {cx_px + fx_px * d.x(), cy_px + fy_px * d.y()};
}

LocalPixelMap CameraCalibration::localMap(const Eigen::Vector2d& p_mm) const {
  const Eigen::Vector3d c = inCamera(X_CP, p_mm);
  const double depth_mm = scaleDepth(*this, c);
  const Eigen::Vector2d n = c.head<2>() / depth_mm;
  const Distorted d = distort(distortion, n);
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1.0, 0.0, -n.x(), 0.0, 1.0, -n.y();
  if (telecentric_mm > 0.0) projection.col(2).setZero();
  const Eigen::Matrix2d n_per_mm = projection * X_CP.linear().leftCols<2>() / depth_mm;
  LocalPixelMap out;
  out.pixel = {cx_px + fx_px * d.point.x(), cy_px + fy_px * d.point.y()};
  out.pixel_per_mm = Eigen::Vector2d(fx_px, fy_px).asDiagonal() * d.jacobian * n_per_mm;
  return out;
}

std::optional<Eigen::Vector2d> CameraCalibration::pixelIfSeen(const Eigen::Vector2d& p_mm,
                                                              double border_px) const {
  const Eigen::Vector3d c = X_CP * Eigen::Vector3d(p_mm.x(), p_mm.y(), 0.0);
  if (!(c.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d n = c.head<2>() / scaleDepth(*this, c);
  const double r2 = n.squaredNorm();
  const auto [k1, k2, p1, p2, k3] = distortion;
  if (!(1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3)) > 0.0)) return std::nullopt;
  const Eigen::Vector2d d = distort(distortion, n).point;
  const Eigen::Vector2d pixel(cx_px + fx_px * d.x(), cy_px + fy_px * d.y());
  const bool seen = pixel.x() >= border_px && pixel.y() >= border_px &&
                    pixel.x() <= width_px - 1 - border_px && pixel.y() <= height_px - 1 - border_px;
  return seen ? std::optional(pixel) : std::nullopt;
}

Eigen::Vector2d CameraCalibration::sightSlope(const Eigen::Vector2d& p_mm) const {
  if (telecentric_mm > 0.0) return Eigen::Vector2d::Zero();
  const Eigen::Vector3d camera_P = X_CP.inverse().translation();
  return (p_mm - camera_P.head<2>()) / std::abs(camera_P.z());
}

CameraCalibration CameraCalibration::lowered(double depth_mm) const {
  CameraCalibration below = *this;
  // A view of a flat target and its mirror image in depth are the same by parallel rays: how far the lens is
  // from square the views tell, and to which side not. A shift to the wrong side would double the error.
  if (telecentric_mm > 0.0) return below;
  const Eigen::Vector3d normal_C = X_CP.linear().col(2);
  below.X_CP.translation() += (normal_C.z() > 0.0 ? depth_mm : -depth_mm) * normal_C;
  return below;
}

double CameraCalibration::pitchMm() const {
  const Eigen::Vector2d centre(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  return 1.0 / localMap(planeFromPixel(centre)).pxPerMm();
}

}  // namespace kerfbench::vision

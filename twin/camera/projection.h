// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/camera/camera.h"

namespace kerfbench::twin {

/// How a line of sight runs on below the plane: at the depth h it is at p + h (at_origin + per_mm p), p being
/// where it crosses the plane.
struct SightSlope {
  Eigen::Vector2d at_origin{Eigen::Vector2d::Zero()};
  double per_mm{};

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& p_P_mm) const {
    return at_origin + per_mm * p_P_mm;
  }
};

/// Maps points of the plane P (z = 0) to pixels, and back. With (a, b) the ray's slopes x/z, y/z in C (of a
/// telecentric lens x and y over telecentric_mm), s = a² + b²:
///
///     a' = a (1 + k1 s + k2 s² + k3 s³) + 2 p1 a b + p2 (s + 2 a²)
///     b' = b (1 + k1 s + k2 s² + k3 s³) + p1 (s + 2 b²) + 2 p2 a b
///     u  = fx a' + cx,  v = fy b' + cy
///
/// Beyond the slope where the radial part turns back on itself nothing is seen: a far point must not fold
/// into view.
class PlaneProjection {
 public:
  explicit PlaneProjection(const CameraDescription& camera);

  /// Pixel of a point; nullopt behind the camera or beyond the fold.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixelOf(const Eigen::Vector2d& p_P_mm) const;
  /// Jacobian d(pixel)/d(p_P), px/mm.
  [[nodiscard]] Eigen::Matrix2d jacobianAt(const Eigen::Vector2d& p_P_mm) const;
  /// Point seen at a pixel, by Newton's method to 1e-13 of a slope; nullopt where the ray misses the plane.
  [[nodiscard]] std::optional<Eigen::Vector2d> planePointOf(const Eigen::Vector2d& pixel) const;
  /// Lines of sight below the plane, away from the camera.
  [[nodiscard]] SightSlope sightSlope() const;

 private:
  struct Slopes {
    Eigen::Vector2d value;
    Eigen::Matrix2d derivative;
  };
  [[nodiscard]] Slopes distort(const Eigen::Vector2d& slopes) const;

  Eigen::Vector2d focal_px_;
  Eigen::Vector2d centre_px_;
  std::array<double, 5> distortion_;
  double telecentric_mm_;  ///< 0: a pinhole.
  Eigen::Isometry3d X_CP_;
  double fold_slope2_;  ///< s where the radial part folds; infinity if never.
};

/// A biquadratic stand-in for planePointOf() over a small rectangle of pixels: exact to 1e-6 mm over a few
/// dozen pixels.
class PlanePatch {
 public:
  /// Points seen at the 3 x 3 corners, middles and centre, row by row.
  using Nodes = std::array<Eigen::Vector2d, 9>;
  explicit PlanePatch(const Nodes& nodes);

  /// The point at (s, t) in 0…1 across and down the rectangle.
  [[nodiscard]] Eigen::Vector2d at(double s, double t) const {
    return alongRow(t, 0) + s * (alongRow(t, 1) + s * alongRow(t, 2));
  }
  /// Coefficient of s^power on the row t.
  [[nodiscard]] Eigen::Vector2d alongRow(double t, int power) const {
    const std::size_t p = static_cast<std::size_t>(power);
    return c_[0][p] + t * (c_[1][p] + t * c_[2][p]);
  }

 private:
  std::array<std::array<Eigen::Vector2d, 3>, 3> c_;  ///< [power of t][power of s]
};

/// Box of the plane that the picture covers wholly (inscribed) or at most (circumscribed).
struct PlaneField {
  Eigen::AlignedBox2d inscribed;
  Eigen::AlignedBox2d circumscribed;
};
/// @throws std::invalid_argument if a border pixel sees no point of the plane.
PlaneField fieldOf(const PlaneProjection& projection, int width_px, int height_px);

}  // namespace kerfbench::twin

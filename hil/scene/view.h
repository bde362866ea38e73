// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::scene {

/// A pinhole that looks at a scene. Image coordinates: pixel centres at integers, x to the right, y down.
class Viewpoint {
 public:
  /// Looks along `direction`, with Wz upwards in the picture, from so far that all points are within the
  /// picture. `share`: of the picture that they may fill, in (0, 1], about its middle, but for the share
  /// `right_free` of its width at the right, in [0, share / 2).
  /// @throws std::invalid_argument for no points, a size of no pixels, a direction along Wz or of length 0.
  static Viewpoint around(const std::vector<Eigen::Vector3d>& points_W_mm, const Eigen::Vector3d& direction,
                          int width_px, int height_px, double share = 0.94, double right_free = 0.0);

  /// Looks from `place_mm` at the middle of points, which fill `share` of a square picture, in (0, 1].
  /// @throws std::invalid_argument for no points, a size of no pixels, points that are not in front of it, or
  /// straight above or below it.
  static Viewpoint from(const Eigen::Vector3d& place_mm, const std::vector<Eigen::Vector3d>& points_W_mm,
                        int side_px, double share);

  [[nodiscard]] const Eigen::Vector3d& place_mm() const { return place_mm_; }
  [[nodiscard]] const Eigen::Vector3d& right() const { return right_; }
  [[nodiscard]] const Eigen::Vector3d& up() const { return up_; }
  [[nodiscard]] const Eigen::Vector3d& forward() const { return forward_; }
  [[nodiscard]] double half_width_tan() const {
    return half_width_tan_;
  }  ///< Half the picture's width at distance 1.
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

  /// Pixel of a point; nullopt behind the pinhole.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_W_mm) const;
  /// Width of a pixel at a point's distance, mm.
  [[nodiscard]] double pixel_mm(const Eigen::Vector3d& p_W_mm) const;

 private:
  Eigen::Vector3d place_mm_, right_, up_, forward_;
  double half_width_tan_{};
  int width_px_{}, height_px_{};
};

}  // namespace kerfbench::scene

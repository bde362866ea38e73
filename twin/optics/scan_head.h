// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::twin {

/// A straight ray; direction has length 1.
struct Ray {
  Eigen::Vector3d p_W_mm{Eigen::Vector3d::Zero()};
  Eigen::Vector3d direction{-Eigen::Vector3d::UnitZ()};
};

/// Where and how the beam meets the work plane z = 0.
struct BeamSpot {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};
  double stretch_x{1.0};  ///< Of the footprint along Wx by oblique incidence, >= 1.
  double stretch_y{1.0};
};

/// Two mirrors above a sheet, by ray trace. The X mirror comes first, at (0, -d, L) and turns about -Wz; its
/// normal at rest is (-1, 1, 0)/sqrt 2 and the laser beam reaches it along +Wx. The Y mirror is at (0, 0, L),
/// turns about +Wx and has (0, -1, -1)/sqrt 2. Both reflecting surfaces hold their axis. With mirror angles
/// a, b this gives
///
///     y = L tan 2b,   x = (sqrt(L² + y²) + d) tan 2a          (Cheng et al. 2014, eq. 1)
///
/// which is a result here and no input: nothing of it is shared with the controller's inverse.
class ScanHead {
 public:
  /// @throws std::invalid_argument unless throw > 0 and spacing >= 0.
  ScanHead(double throw_mm, double mirror_spacing_mm);

  [[nodiscard]] const Eigen::Vector3d& xMirrorPlace_mm() const { return p_WX_mm_; }
  [[nodiscard]] const Eigen::Vector3d& yMirrorPlace_mm() const { return p_WY_mm_; }
  [[nodiscard]] static Eigen::Vector3d xMirrorAxis() { return -Eigen::Vector3d::UnitZ(); }
  [[nodiscard]] static Eigen::Vector3d yMirrorAxis() { return Eigen::Vector3d::UnitX(); }

  /// The spot for the mirrors' rotations from rest; nullopt if the ray misses a mirror's front or the plane.
  [[nodiscard]] std::optional<BeamSpot> spotAt(const Eigen::Matrix3d& R_x, const Eigen::Matrix3d& R_y) const;

 private:
  Eigen::Vector3d p_WX_mm_;
  Eigen::Vector3d p_WY_mm_;
};

/// A beam straight down from a gantry at (x, y).
BeamSpot gantrySpot(double x_mm, double y_mm);

}  // namespace kerfbench::twin

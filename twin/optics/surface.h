// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "twin/optics/optics_description.h"

namespace kerfbench::twin {

/// A point of the board's surface.
struct SurfacePoint {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};
  double height_mm{};
  Eigen::Vector2d slope{Eigen::Vector2d::Zero()};  ///< Slopes dz/dx, dz/dy at the point.
};

/// The board's surface as a height over the work plane. Immutable.
class Surface {
 public:
  /// Makes a surface. @throws std::invalid_argument with all of faultsOf(description).
  explicit Surface(const SurfaceDescription& description);

  [[nodiscard]] double height_mm(const Eigen::Vector2d& p_WQ_mm, double time_s) const;
  /// Height and slope at a place.
  [[nodiscard]] SurfacePoint at(const Eigen::Vector2d& p_WQ_mm, double time_s) const;

  /// Intersection of a straight line with the surface. The line passes the work plane at `foot_W_mm` and runs
  /// by `run` (dx/dz, dy/dz) for each mm of height. In closed form where the surface is plane, else by
  /// Newton's method to 1e-12 mm of height. nullopt if the method does not converge in 50 steps, as when
  /// there is no such point.
  [[nodiscard]] std::optional<SurfacePoint> meet(const Eigen::Vector2d& foot_W_mm, const Eigen::Vector2d& run,
                                                 double time_s) const;

 private:
  struct Local {
    double height_mm{};
    Eigen::Vector2d slope;
    Eigen::Vector2d bend_1_mm;  ///< Second derivatives along x and y; the mixed one is zero.
  };
  [[nodiscard]] Local localAt(const Eigen::Vector2d& p_WQ_mm, double time_s) const;

  SurfaceDescription description_;
  double wave_rad_mm_;     ///< Wave number 2 pi / wavelength.
  double most_bend_1_mm_;  ///< Bound on the second derivatives.
  bool level_;             ///< True if the surface has height alone.
  bool plane_;             ///< True if the surface has height and slope alone.
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "twin/optics/surface.h"

namespace kerfbench::twin {

/// Place and shape of the beam on the board: the footprint's 1/e² ellipse as seen along Wz, that is (p -
/// p_WQ)ᵀ S⁻¹ (p - p_WQ) = 1 with S = (rx², correlation rx ry; correlation rx ry, ry²).
struct BeamSpot {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};
  double height_mm{};  ///< Height of the surface at the spot.
  double radius_x_mm{};
  double radius_y_mm{};
  double correlation{};  ///< |.| < 1
};

/// The last straight piece of the beam's axis.
struct ChiefRay {
  Eigen::Vector3d p_W_mm;     ///< A point of the axis.
  Eigen::Vector3d direction;  ///< Unit vector, downwards.
  double waist_mm{};          ///< Distance of the waist from the point, along the direction.
  double start_mm{};          ///< Distance of the piece's begin from the point, along the direction.
};

/// Radius of a Gaussian beam along its path, w² = w0² (1 + (s / zR)²), and its intersection with a surface.
class BeamCaustic {
 public:
  BeamCaustic(double waist_radius_mm, double rayleigh_mm)
      : squared_mm2_(waist_radius_mm * waist_radius_mm), per_rayleigh_(1.0 / rayleigh_mm) {}

  /// Squared radius w² at a distance from the waist.
  [[nodiscard]] double squaredRadius_mm2(double from_waist_mm) const {
    const double s = from_waist_mm * per_rayleigh_;
    return squared_mm2_ * (1.0 + s * s);
  }

  /// Footprint of the beam where its axis first meets the surface, taken as plane there: the radius is that
  /// at the axis. The cylinder |q|² - (k·q)² = w² cut by the tangent plane q = (p, slope·p) gives S = w² (JᵀJ
  /// - (Jᵀk)(Jᵀk)ᵀ)⁻¹, J = (1; slopeᵀ): on a level board w² (I + k kᵀ / kz²). nullopt if there is no
  /// intersection beyond the ray's start with a cosine of incidence of `flattest` or more.
  [[nodiscard]] std::optional<BeamSpot> spotOn(const Surface& surface, double time_s, const ChiefRay& ray,
                                               double flattest) const;

 private:
  double squared_mm2_;
  double per_rayleigh_;
};

}  // namespace kerfbench::twin

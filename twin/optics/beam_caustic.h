// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "twin/optics/surface.h"

namespace kerfbench::twin {

/// Where and how the beam meets the board: the footprint's 1/e² ellipse as seen along Wz, that is
/// (p - p_WQ)ᵀ S⁻¹ (p - p_WQ) = 1 with S = (rx², correlation rx ry; correlation rx ry, ry²).
struct BeamSpot {
  Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};
  double height_mm{};  ///< Height of the surface there.
  double radius_x_mm{};
  double radius_y_mm{};
  double correlation{};  ///< |.| < 1
};

/// The last straight piece of the beam's axis.
struct ChiefRay {
  Eigen::Vector3d p_W_mm;     ///< A point of it.
  Eigen::Vector3d direction;  ///< Length 1, downwards.
  double waist_mm{};          ///< The waist lies this far from the point, along the direction.
  double start_mm{};          ///< And here, likewise, the piece begins.
};

/// A Gaussian beam's radius along its path, w² = w0² (1 + (s / zR)²), and its cut with a surface.
class BeamCaustic {
 public:
  BeamCaustic(double waist_radius_mm, double rayleigh_mm)
      : squared_mm2_(waist_radius_mm * waist_radius_mm), per_rayleigh_(1.0 / rayleigh_mm) {}

  /// w² at a distance from the waist.
  [[nodiscard]] double squaredRadius_mm2(double from_waist_mm) const {
    const double s = from_waist_mm * per_rayleigh_;
    return squared_mm2_ * (1.0 + s * s);
  }

  /// The beam's footprint where its axis first meets the surface, taken as plane there: the radius is that at
  /// the axis. The cylinder |q|² - (k·q)² = w² cut by the tangent plane q = (p, slope·p) gives
  /// S = w² (JᵀJ - (Jᵀk)(Jᵀk)ᵀ)⁻¹, J = (1; slopeᵀ): on a level board w² (I + k kᵀ / kz²).
  /// nullopt without a meeting beyond the ray's start with a cosine of incidence of `flattest` or more.
  [[nodiscard]] std::optional<BeamSpot> spotOn(const Surface& surface, double time_s, const ChiefRay& ray,
                                               double flattest) const;

 private:
  double squared_mm2_;
  double per_rayleigh_;
};

}  // namespace kerfbench::twin

// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/beam_caustic.h"

#include <cmath>

namespace kerfbench::twin {

std::optional<BeamSpot> BeamCaustic::spotOn(const Surface& surface, double time_s, const ChiefRay& ray,
                                            double flattest) const {
  const Eigen::Vector3d& k = ray.direction;
  const Eigen::Vector2d run = k.head<2>() / k.z();
  const Eigen::Vector2d foot_mm = ray.p_W_mm.head<2>() - ray.p_W_mm.z() * run;
  const auto point = surface.meet(foot_mm, run, time_s);
  if (!point) return std::nullopt;
  const double distance_mm = (point->height_mm - ray.p_W_mm.z()) / k.z();
  const Eigen::Vector2d& slope = point->slope;
  // Cosine towards the surface, -k·(-slope, 1); > 0 from above.
  const double into = slope.dot(k.head<2>()) - k.z();
  const double into2 = into * into;
  const bool steep_enough = into > 0 && into2 >= flattest * flattest * (1.0 + slope.squaredNorm());
  if (!(distance_mm >= ray.start_mm) || !steep_enough) return std::nullopt;

  const Eigen::Vector2d along = k.head<2>() + k.z() * slope;
  const double m_xx = 1.0 + slope.x() * slope.x() - along.x() * along.x();
  const double m_yy = 1.0 + slope.y() * slope.y() - along.y() * along.y();
  const double m_xy = slope.x() * slope.y() - along.x() * along.y();
  // The divisor into² is the determinant.
  const double share = squaredRadius_mm2(distance_mm - ray.waist_mm) / into2;
  BeamSpot spot{point->p_WQ_mm, point->height_mm, std::sqrt(share * m_yy), std::sqrt(share * m_xx), 0.0};
  spot.correlation = -share * m_xy / (spot.radius_x_mm * spot.radius_y_mm);
  if (!(spot.p_WQ_mm.squaredNorm() < INFINITY)) return std::nullopt;
  return spot;
}

}  // namespace kerfbench::twin

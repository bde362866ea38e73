// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace kerfbench::trace {

/// Distance of a place from a straight piece, mm.
inline double distanceToChord_mm(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& from_mm,
                                 const Eigen::Vector2d& to_mm) {
  const Eigen::Vector2d way = to_mm - from_mm;
  const double square = way.squaredNorm();
  const double share = square > 0.0 ? std::clamp((p_mm - from_mm).dot(way) / square, 0.0, 1.0) : 0.0;
  return (from_mm + share * way - p_mm).norm();
}

}  // namespace kerfbench::trace

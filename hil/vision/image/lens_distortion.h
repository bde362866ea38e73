// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace kerfbench::vision {

/// A point of the normalised picture as the lens moves it, with the Jacobian.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// OpenCV's lens polynomial, k1 k2 p1 p2 k3, on normalised coordinates (x / z, y / z).
inline Distorted distort(const std::array<double, 5>& d, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const auto [k1, k2, p1, p2, k3] = d;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // d(radial)/d(r²)
  const double mixed = 2.0 * (x * y * slope + p1 * x + p2 * y);
  Distorted out;
  out.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
               y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  out.jacobian << radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed, mixed,
      radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return out;
}

}  // namespace kerfbench::vision

// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "twin/base/symmetric_eigen.h"

namespace kerfbench::vision {
namespace {

using Vector = SpotParameters::Vector;

/// exp(-x), and nothing where it is too small to matter.
double decay(double x) { return x < 30.0 ? std::exp(-x) : 0.0; }

SpotLight bellAt(const Vector& q, double dx, double dy, Vector* derivative) {
  SpotLight light;
  light.bell = decay(0.5 * (q[2] * dx * dx + 2.0 * q[3] * dx * dy + q[4] * dy * dy));
  if (derivative != nullptr) {
    const double s = q[5] * light.bell;
    *derivative << s * (q[2] * dx + q[3] * dy), s * (q[3] * dx + q[4] * dy), -0.5 * s * dx * dx, -s * dx * dy,
        -0.5 * s * dy * dy, light.bell, 1.0, 0.0;
  }
  return light;
}

/// Along the line (a) the bell is integrated from -half to half, across it (c) it is as it is.
SpotLight streakAt(const Vector& q, double dx, double dy, Vector* derivative) {
  const double half = std::hypot(q[2], q[3]);
  const Eigen::Vector2d u(q[2] / half, q[3] / half);
  const double a = dx * u.x() + dy * u.y();
  const double c = -dx * u.y() + dy * u.x();
  const double p = q[4];
  SpotLight light;
  const double across = decay(0.5 * c * c * p);
  if (across == 0.0 && derivative == nullptr) return light;
  const double root = std::sqrt(0.5 * p);
  const double near = a - half;
  const double far = a + half;
  const double integral =
      0.5 * std::sqrt(std::numbers::pi) / root * (std::erf(far * root) - std::erf(near * root));
  const double share = across / (2.0 * half);
  light.bell = share * integral;
  if (derivative != nullptr) {
    const double at_near = decay(0.5 * near * near * p);
    const double at_far = decay(0.5 * far * far * p);
    const double by_a = share * (at_far - at_near);
    const double by_c = -c * p * light.bell;
    const double by_half = share * (at_far + at_near) - light.bell / half;
    const double by_turn = (c * by_a - a * by_c) / half;
    const double second = (near * at_near - far * at_far + integral) / p;
    const double by_p = -0.5 * (c * c * light.bell + share * second);
    *derivative << -(by_a * u.x() - by_c * u.y()), -(by_a * u.y() + by_c * u.x()),
        by_half * u.x() - by_turn * u.y(), by_half * u.y() + by_turn * u.x(), by_p, 0.0, 0.0, 0.0;
    *derivative *= q[5];
    (*derivative)[5] = light.bell;
    (*derivative)[6] = 1.0;
  }
  return light;
}

SpotLight lightAt(SpotShape shape, const Vector& q, double c, double r, double cover, Vector* derivative) {
  SpotLight light = shape == SpotShape::kBell ? bellAt(q, c - q[0], r - q[1], derivative)
                                              : streakAt(q, c - q[0], r - q[1], derivative);
  light.value = q[5] * light.bell + q[6] + q[7] * cover;
  if (derivative != nullptr) (*derivative)[7] = cover;
  return light;
}

}  // namespace

SpotLight spotLight(SpotShape shape, const Vector& q, double c, double r, double cover) {
  return lightAt(shape, q, c, r, cover, nullptr);
}

SpotLight spotLight(SpotShape shape, const Vector& q, double c, double r, double cover, Vector& derivative) {
  return lightAt(shape, q, c, r, cover, &derivative);
}

Eigen::Matrix2d momentsOf(SpotShape shape, const Vector& q) {
  if (shape == SpotShape::kBell) {
    Eigen::Matrix2d inverse;
    inverse << q[2], q[3], q[3], q[4];
    return inverse.inverse();
  }
  const Eigen::Vector2d half(q[2], q[3]);
  return Eigen::Matrix2d::Identity() / q[4] + half * half.transpose() / 3.0;
}

Vector streakLike(const Vector& bell) {
  const SymmetricEigen<2> axes(momentsOf(SpotShape::kBell, bell));
  const double narrow = axes.values.x();
  const double wide = axes.values.y();
  const Eigen::Vector2d half = axes.vectors.col(1) * std::sqrt(3.0 * (wide - narrow));
  Vector q = bell;
  q[2] = half.x();
  q[3] = half.y();
  q[4] = 1.0 / narrow;
  q[5] = bell[5] * std::sqrt(wide / narrow);
  return q;
}

bool plausible(SpotShape shape, const Vector& q) {
  if (!q.allFinite() || !(q[5] > 0.0 && q[5] < 1e5)) return false;
  if (shape == SpotShape::kBell)
    return q[5] < 8000.0 && q[2] > 0.0 && q[4] > 0.0 && q[2] * q[4] > q[3] * q[3];
  return q[4] > 0.0 && std::hypot(q[2], q[3]) > 1e-3;
}

}  // namespace kerfbench::vision

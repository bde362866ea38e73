// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/residual_surface.h"

#include <algorithm>
#include <stdexcept>

namespace kerfbench::calibrate {
namespace {

constexpr int kMostDegree = 30;

/// Legendre polynomials 0 … degree and their derivatives at u, by Bonnet's recursion.
struct Legendre {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDegree + 1, 1> value, slope;
  Legendre(int degree, double u) : value(degree + 1), slope(degree + 1) {
    value[0] = 1.0;
    slope[0] = 0.0;
    if (degree < 1) return;
    value[1] = u;
    slope[1] = 1.0;
    for (int n = 1; n < degree; ++n) {
      value[n + 1] = ((2 * n + 1) * u * value[n] - n * value[n - 1]) / (n + 1);
      slope[n + 1] = (2 * n + 1) * value[n] + slope[n - 1];
    }
  }
};

}  // namespace

SmoothBasis::SmoothBasis(const Eigen::AlignedBox2d& area_mm, int degree)
    : area_mm_(area_mm), degree_(degree) {
  if (degree < 0 || degree > kMostDegree) throw std::invalid_argument("degree must be 0 … 30");
  if (area_mm.isEmpty() || !(area_mm.sizes().minCoeff() > 0.0))
    throw std::invalid_argument("area_mm must not be empty");
  for (int total = 0; total <= degree; ++total) {
    for (int i = total; i >= 0; --i) orders_.emplace_back(i, total - i);
  }
}

Eigen::Vector2d SmoothBasis::onUnitSquare(const Eigen::Vector2d& p_mm) const {
  return (p_mm - area_mm_.center()).cwiseQuotient(0.5 * area_mm_.sizes());
}

Eigen::VectorXd SmoothBasis::valuesAt(const Eigen::Vector2d& p_mm) const {
  const Eigen::Vector2d inside = onUnitSquare(p_mm).cwiseMax(-1.0).cwiseMin(1.0);
  const Legendre u(degree_, inside.x());
  const Legendre v(degree_, inside.y());
  Eigen::VectorXd values(size());
  for (Eigen::Index k = 0; k < size(); ++k) values[k] = u.value[order(k).x()] * v.value[order(k).y()];
  return values;
}

SmoothBasis::Values SmoothBasis::at(const Eigen::Vector2d& p_mm) const {
  const Eigen::Vector2d half_mm = 0.5 * area_mm_.sizes();
  const Eigen::Vector2d wanted = onUnitSquare(p_mm);
  const Eigen::Vector2d inside = wanted.cwiseMax(-1.0).cwiseMin(1.0);
  const Legendre u(degree_, inside.x());
  const Legendre v(degree_, inside.y());
  const double u_per_mm = inside.x() == wanted.x() ? 1.0 / half_mm.x() : 0.0;
  const double v_per_mm = inside.y() == wanted.y() ? 1.0 / half_mm.y() : 0.0;
  Values values{valuesAt(p_mm), Eigen::MatrixX2d(size(), 2)};
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Eigen::Vector2i& o = order(k);
    values.by_p(k, 0) = u_per_mm * u.slope[o.x()] * v.value[o.y()];
    values.by_p(k, 1) = v_per_mm * u.value[o.x()] * v.slope[o.y()];
  }
  return values;
}

}  // namespace kerfbench::calibrate

// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/spline.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector3d;

void check(const Nurbs& s) {
  if (s.degree < 1 || s.degree > 3) {
    throw std::invalid_argument(
        fmt::format("degree {} is not supported; 1 to 3 are (save with degree 3)", s.degree));
  }
  const std::size_t n = s.control_mm.size();
  const auto p = static_cast<std::size_t>(s.degree);
  if (n < p + 1)
    throw std::invalid_argument(fmt::format("{} control points are too few for degree {}", n, s.degree));
  if (s.knots.size() != n + p + 1) {
    throw std::invalid_argument(fmt::format("{} control points of degree {} need {} knots, found {}", n,
                                            s.degree, n + p + 1, s.knots.size()));
  }
  if (s.weights.size() != n)
    throw std::invalid_argument(fmt::format("{} control points but {} weights", n, s.weights.size()));
  for (const double w : s.weights) {
    if (!(w > 0)) throw std::invalid_argument("a weight is not positive");
  }
  if (!std::is_sorted(s.knots.begin(), s.knots.end())) throw std::invalid_argument("the knots decrease");
  if (!(s.knots[n] > s.knots[p])) throw std::invalid_argument("the knots span no interval");
  // degree + 1 equal knots inside the domain tear the curve apart.
  for (std::size_t i = p + 1; i + p < n; ++i) {
    if (s.knots[i] == s.knots[i + p] && s.knots[i] > s.knots[p] && s.knots[i] < s.knots[n]) {
      throw std::invalid_argument("a knot inside is repeated more often than the degree");
    }
  }
}

/// The polar form of the spline on span j (knots[j] < knots[j + 1]) at `args`, one per degree (Ramshaw 1989):
/// de Boor's recursion with a different argument at each level. At (a…a b…b) it is a Bézier control point on
/// [a, b].
Vector3d polar(const Nurbs& s, std::size_t j, const std::array<double, 3>& args) {
  const auto p = static_cast<std::size_t>(s.degree);
  std::array<Vector3d, 4> d;
  for (std::size_t i = 0; i <= p; ++i) {
    const std::size_t k = j - p + i;
    d[i] << s.weights[k] * s.control_mm[k], s.weights[k];
  }
  for (std::size_t r = 1; r <= p; ++r) {
    for (std::size_t i = p; i >= r; --i) {
      const double lo = s.knots[j - p + i];
      const double hi = s.knots[j + 1 + i - r];
      const double alpha = (args[r - 1] - lo) / (hi - lo);
      d[i] = (1 - alpha) * d[i - 1] + alpha * d[i];
    }
  }
  return d[p];
}

BezierCurve cubic(const std::array<Vector3d, 4>& h) {
  BezierCurve bezier;
  for (int i = 0; i < 4; ++i) {
    const Vector3d& point = h[static_cast<std::size_t>(i)];
    bezier.control_mm.col(i) = point.head<2>() / point.z();
    bezier.weight(i) = point.z();
  }
  return bezier;
}

}  // namespace

std::vector<Curve> toBeziers(const Nurbs& s) {
  check(s);
  const auto p = static_cast<std::size_t>(s.degree);
  std::vector<Curve> curves;
  for (std::size_t j = p; j < s.control_mm.size(); ++j) {
    const double a = s.knots[j];
    const double b = s.knots[j + 1];
    if (!(b > a)) continue;
    std::array<Vector3d, 4> h;
    for (std::size_t k = 0; k <= p; ++k) {
      std::array<double, 3> args{a, a, a};
      for (std::size_t i = 0; i < k; ++i) args[i] = b;
      h[k] = polar(s, j, args);
    }
    if (p == 1) {
      curves.emplace_back(LineCurve{h[0].head<2>() / h[0].z(), h[1].head<2>() / h[1].z()});
      continue;
    }
    if (p == 2) h = {h[0], Vector3d((h[0] + 2 * h[1]) / 3), Vector3d((2 * h[1] + h[2]) / 3), h[2]};
    curves.emplace_back(cubic(h));
  }
  return curves;
}

}  // namespace kerfbench::dieline

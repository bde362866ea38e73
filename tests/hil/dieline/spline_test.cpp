// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/spline.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

/// Cox and de Boor's basis function: an evaluation that shares nothing with the polar form.
double basis(const Nurbs& s, std::size_t i, int p, double t) {
  if (p == 0) return t >= s.knots[i] && t < s.knots[i + 1] ? 1.0 : 0.0;
  const auto q = static_cast<std::size_t>(p);
  double sum = 0;
  if (s.knots[i + q] > s.knots[i])
    sum += (t - s.knots[i]) / (s.knots[i + q] - s.knots[i]) * basis(s, i, p - 1, t);
  if (s.knots[i + q + 1] > s.knots[i + 1]) {
    sum += (s.knots[i + q + 1] - t) / (s.knots[i + q + 1] - s.knots[i + 1]) * basis(s, i + 1, p - 1, t);
  }
  return sum;
}

Vector2d evaluate(const Nurbs& s, double t) {
  Vector2d sum = Vector2d::Zero();
  double weight = 0;
  for (std::size_t i = 0; i < s.control_mm.size(); ++i) {
    const double b = basis(s, i, s.degree, t) * s.weights[i];
    sum += b * s.control_mm[i];
    weight += b;
  }
  return sum / weight;
}

void expectSame(const Nurbs& s) {
  const auto curves = toBeziers(s);
  std::size_t k = 0;
  for (std::size_t j = static_cast<std::size_t>(s.degree); j < s.control_mm.size(); ++j) {
    const double a = s.knots[j];
    const double b = s.knots[j + 1];
    if (b <= a) continue;
    ASSERT_LT(k, curves.size());
    for (const double u : {0.0, 0.25, 0.6, 0.999}) {
      EXPECT_LT((pointAt(curves[k], u) - evaluate(s, a + u * (b - a))).norm(), 1e-12)
          << "span " << k << " u " << u;
    }
    ++k;
  }
  EXPECT_EQ(k, curves.size());
}

const std::vector<Vector2d> kPoints{{0, 0}, {1, 4}, {3, 5}, {6, 1}, {8, 2}, {9, 7}};

TEST(Spline, OfEachDegreeAgreesWithTheBasisFunctions) {
  expectSame({1, {0, 0, 1, 2, 3, 5, 5, 5 + 1}, kPoints, {1, 1, 1, 1, 1, 1}});
  expectSame({2, {0, 0, 0, 1, 2, 3, 4, 4, 4}, kPoints, {1, 1, 1, 1, 1, 1}});
  expectSame({3, {0, 0, 0, 0, 1, 2.5, 4, 4, 4, 4}, kPoints, {1, 1, 1, 1, 1, 1}});
}

TEST(Spline, WithWeightsAgrees) {
  expectSame({2, {0, 0, 0, 1, 2, 3, 4, 4, 4}, kPoints, {1, 0.5, 3, 1, 2, 1}});
  expectSame({3, {0, 0, 0, 0, 1, 2.5, 4, 4, 4, 4}, kPoints, {1, 0.5, 3, 1, 2, 1}});
}

TEST(Spline, WithRepeatedAndUnclampedKnotsAgrees) {
  expectSame({3, {0, 0, 0, 0, 2, 2, 4, 4, 4, 4}, kPoints, {1, 1, 2, 1, 1, 1}});
  expectSame({3, {-3, -2, -1, 0, 1, 2, 3, 4, 5, 6}, kPoints, {1, 1, 1, 1, 1, 1}});
}

TEST(Spline, ThatIsBrokenIsRefused) {
  const std::vector<double> ones(6, 1.0);
  EXPECT_THROW(toBeziers({4, {0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2}, kPoints, ones}), std::invalid_argument);
  EXPECT_THROW(toBeziers({3, {0, 0, 0, 0, 1, 2, 3, 3, 3}, kPoints, ones}), std::invalid_argument);
  EXPECT_THROW(toBeziers({3, {0, 0, 0, 0, 3, 2, 4, 4, 4, 4}, kPoints, ones}), std::invalid_argument);
  EXPECT_THROW(toBeziers({3, std::vector<double>(10, 1.0), kPoints, ones}), std::invalid_argument);
  EXPECT_THROW(toBeziers({3, {0, 0, 0, 0, 1, 2, 4, 4, 4, 4}, kPoints, {1, 1, 0, 1, 1, 1}}),
               std::invalid_argument);
  EXPECT_THROW(toBeziers({3, {0, 0, 0, 0, 1, 2, 4, 4, 4, 4}, kPoints, {1, 1, 1}}), std::invalid_argument);
  EXPECT_THROW(toBeziers({1, {0, 0, 1, 1, 2, 3, 4, 4}, kPoints, ones}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::dieline

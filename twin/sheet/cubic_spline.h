// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>

namespace kerfbench::twin {

/// Four floats in one register, which every supported processor has.
using Quad = float __attribute__((vector_size(16)));

inline Quad loadQuad(const float* from) {
  Quad quad;
  std::memcpy(&quad, from, sizeof quad);
  return quad;
}
inline void storeQuad(float* to, Quad quad) { std::memcpy(to, &quad, sizeof quad); }

/// Weights of coefficients -1, 0, 1, 2 of the uniform cubic B-spline at t in [0, 1) between nodes 0 and 1.
/// All are >= 0 and add up to one: the spline never overshoots its coefficients.
inline Quad splineWeights(float t) {
  const float s = 1.0F - t;
  const float outer_left = s * s * s * (1.0F / 6.0F);
  const float outer_right = t * t * t * (1.0F / 6.0F);
  const float inner_left = 2.0F / 3.0F - t * t * (1.0F - 0.5F * t);
  return Quad{outer_left, inner_left, 1.0F - outer_left - inner_left - outer_right, outer_right};
}

/// Derivatives of splineWeights() by t.
inline Quad splineSlopeWeights(float t) {
  const float s = 1.0F - t;
  const float outer_left = -0.5F * s * s;
  const float outer_right = 0.5F * t * t;
  const float inner_left = t * (1.5F * t - 2.0F);
  return Quad{outer_left, inner_left, -(outer_left + inner_left + outer_right), outer_right};
}

/// Variance of the cubic B-spline in squared node spacings: the amount that the spline adds to a bell that
/// was stored as coefficients.
inline constexpr double kSplineVariance = 1.0 / 3.0;

/// Value of the spline over the 4 x 4 coefficients whose first is at `nodes`, rows `stride` apart.
inline float splineValue(const float* nodes, std::size_t stride, Quad weights_x, Quad weights_y) {
  const Quad column = loadQuad(nodes) * weights_y[0] + loadQuad(nodes + stride) * weights_y[1] +
                      loadQuad(nodes + 2 * stride) * weights_y[2] +
                      loadQuad(nodes + 3 * stride) * weights_y[3];
  const Quad terms = column * weights_x;
  return (terms[0] + terms[1]) + (terms[2] + terms[3]);
}

}  // namespace kerfbench::twin

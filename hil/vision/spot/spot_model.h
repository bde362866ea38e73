// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::vision {

/// Distribution of a spot's light over the pixels: a Gaussian bell of height 1, or one that ran evenly along
/// a line while the shutter was open, its light spread over the line.
enum class SpotShape { kBell, kStreak };

/// Parameters of a spot in its window:
///   x, y        centre, px
///   shape       kBell: inverse covariance xx, xy, yy, 1/px²;
///               kStreak: half of the line x, y, px, then the bell's inverse variance, 1/px²
///   height      of the bell at rest, grey
///   board, ink  grey of the board, and what a printed disc adds where it covers all (negative)
struct SpotParameters {
  static constexpr int kCount = 8;
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;
};

/// The model at one pixel.
struct SpotLight {
  double bell{};   ///< Share of the height.
  double value{};  ///< Grey, not clipped.
};

/// Light of a pixel; `cover`: share of it under ink.
SpotLight spotLight(SpotShape shape, const SpotParameters::Vector& q, double c, double r, double cover);

/// Light of a pixel with its derivative by the parameters.
SpotLight spotLight(SpotShape shape, const SpotParameters::Vector& q, double c, double r, double cover,
                    SpotParameters::Vector& derivative);

/// Second moments of the light about its centre, px².
Eigen::Matrix2d momentsOf(SpotShape shape, const SpotParameters::Vector& q);

/// The streak with the second moments of a bell, of the same light. The bell must be longer than wide.
SpotParameters::Vector streakLike(const SpotParameters::Vector& bell);

/// Whether these are parameters of a spot at all.
bool plausible(SpotShape shape, const SpotParameters::Vector& q);

}  // namespace kerfbench::vision

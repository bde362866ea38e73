// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/gaussian_footprint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kerfbench::twin {
namespace {

using Lanes = std::array<double, 4>;

/// Smallest variance of a bell whose samples still add up evenly wherever it lies.
constexpr double kMinVariance = 0.25;
/// Variance from which on the samples add up to the integral to 1e-10.
constexpr double kSmoothVariance = 1.2;
/// Smallest value that is sampled: smaller ones would be denormal once multiplied, and slow.
constexpr double kNothing = 1e-12;

Quad single(const Lanes& lanes) {
  return Quad{static_cast<float>(lanes[0]), static_cast<float>(lanes[1]), static_cast<float>(lanes[2]),
              static_cast<float>(lanes[3])};
}

/// Values of exp(linear i - square i²) at i = first, first + 1, …, four at a time: the ratio of neighbours
/// itself changes by a constant factor.
class Parabola {
 public:
  Parabola(double square, double linear, int first) {
    const double i = first;
    double value = std::exp((linear - square * i) * i);
    double ratio = std::exp(linear - square * (2.0 * i + 1.0));
    const double change = std::exp(-2.0 * square);
    const double change2 = change * change;
    const double change4 = change2 * change2;
    double ratio4 = 1.0;
    for (std::size_t l = 0; l < 4; ++l) {
      value_.at(l) = value;
      value *= ratio;
      ratio4 *= ratio;
      ratio *= change;
    }
    for (std::size_t l = 0; l < 4; ++l) {
      ratio_.at(l) = ratio4;
      ratio4 *= change4;
    }
    const double change8 = change4 * change4;
    change_ = change8 * change8;
  }
  [[nodiscard]] const Lanes& value() const { return value_; }
  void next() {
    for (std::size_t l = 0; l < 4; ++l) {
      value_[l] *= ratio_[l];
      ratio_[l] *= change_;
    }
  }

 private:
  Lanes value_, ratio_;
  double change_;
};

}  // namespace

GaussianFootprint splineCoefficientsOf(GaussianFootprint footprint) {
  footprint.variance_x -= kSplineVariance;
  footprint.variance_y -= kSplineVariance;
  if (footprint.covariance == 0.0) {
    footprint.variance_x = std::max(footprint.variance_x, kMinVariance);
    footprint.variance_y = std::max(footprint.variance_y, kMinVariance);
    return footprint;
  }
  // The smaller eigenvalue is no less than kMinVariance: its determinant says so without a root.
  const double room_x = footprint.variance_x - kMinVariance;
  const double room_y = footprint.variance_y - kMinVariance;
  if (room_x >= 0.0 && room_y >= 0.0 && room_x * room_y >= footprint.covariance * footprint.covariance)
    return footprint;
  const double mean = 0.5 * (footprint.variance_x + footprint.variance_y);
  const double half = 0.5 * (footprint.variance_x - footprint.variance_y);
  const double spread = std::sqrt(half * half + footprint.covariance * footprint.covariance);
  const double major = std::max(mean + spread, kMinVariance);
  const double kept_mean = 0.5 * (major + kMinVariance);
  const double kept_share = 0.5 * (major - kMinVariance) / spread;
  return {footprint.centre, kept_mean + half * kept_share, kept_mean - half * kept_share,
          footprint.covariance * kept_share};
}

void SampledBell::sample(const GaussianFootprint& bell, double sum) {
  const double reach_x = kReach * std::sqrt(bell.variance_x);
  const double reach_y = kReach * std::sqrt(bell.variance_y);
  first_column_ = 4 * static_cast<int>(std::floor((bell.centre.x() - reach_x) / 4.0));
  first_row_ = static_cast<int>(std::ceil(bell.centre.y() - reach_y));
  columns_.resize(static_cast<std::size_t>(static_cast<int>(std::floor((bell.centre.x() + reach_x) / 4.0)) +
                                           1 - first_column_ / 4));
  rows_.resize(
      static_cast<std::size_t>(static_cast<int>(std::floor(bell.centre.y() + reach_y)) + 1 - first_row_));

  // Exponent of a whole node (i, j); i and j count from the node that is nearest to the centre.
  const double determinant = bell.variance_x * bell.variance_y - bell.covariance * bell.covariance;
  const double a = 0.5 * bell.variance_y / determinant;
  const double b = -0.5 * bell.covariance / determinant;
  const double c = 0.5 * bell.variance_x / determinant;
  const double near_x = std::floor(bell.centre.x() + 0.5);
  const double near_y = std::floor(bell.centre.y() + 0.5);
  const double x = bell.centre.x() - near_x;
  const double y = bell.centre.y() - near_y;
  const int first_i = first_column_ - static_cast<int>(near_x);
  const int first_j = first_row_ - static_cast<int>(near_y);

  Parabola along(a, 2.0 * (a * x + b * y), first_i);
  for (Quad& column : columns_) {
    Lanes kept = along.value();
    for (double& value : kept) value = value < kNothing ? 0.0 : value;
    column = single(kept);
    along.next();
  }

  const bool smooth = std::min(bell.variance_x, bell.variance_y) >= kSmoothVariance;
  const double peak = smooth ? sum / (2.0 * std::numbers::pi * std::sqrt(determinant)) : 1.0;
  const double linear = 2.0 * (c * y + b * x);
  const double j = first_j;
  const double offset = (a * x + 2.0 * b * y) * x + c * y * y;
  double start = peak * std::exp((linear - c * j - 2.0 * b * first_i) * j - offset);
  double ratio = std::exp(linear - c * (2.0 * j + 1.0) - 2.0 * b * first_i);
  const double change = std::exp(-2.0 * c);
  const double g = b == 0.0 ? 1.0 : std::exp(-2.0 * b);
  const double g_j = b == 0.0 ? 1.0 : std::exp(-2.0 * b * j);
  Lanes starts, ratios;
  for (std::size_t l = 0; l < 4; ++l) {
    starts.at(l) = start;
    ratios.at(l) = ratio;
    start *= g_j;
    ratio *= g;
  }
  const double g4 = (g * g) * (g * g);
  double step = (g_j * g_j) * (g_j * g_j);
  for (Row& row : rows_) {
    row = {single(starts), static_cast<float>(step)};
    for (std::size_t l = 0; l < 4; ++l) {
      starts[l] *= ratios[l];
      ratios[l] *= change;
    }
    step *= g4;
  }
  if (!smooth) scaleTo(sum);
}

void SampledBell::scaleTo(double sum) {
  double found = 0.0;
  for (const Row& row : rows_) {
    Quad factor = row.start;
    Quad line{};
    for (const Quad& column : columns_) {
      line += column * factor;
      factor *= row.step;
    }
    found += static_cast<double>((line[0] + line[1]) + (line[2] + line[3]));
  }
  const auto scale = static_cast<float>(sum / found);
  for (Row& row : rows_) row.start *= scale;
}

}  // namespace kerfbench::twin

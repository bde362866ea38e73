// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_misfit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

namespace kerfbench::vision {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Chi square that `count` values exceed together with this probability at most.
double chiSquareOf(std::size_t count, int freedom, double chance) {
  const double each = chance / static_cast<double>(count);
  if (freedom == 2) return -2.0 * std::log(each);
  // One degree of freedom: the tail of a normal value, which falls as its argument grows.
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > each ? low : high) = middle;
  }
  return low * low;
}

/// Residuals of least squares, each axis weighted by its sigma, and their covariance.
struct Residuals {
  Eigen::VectorXd mm;
  Eigen::MatrixXd covariance;
};

Residuals residualsOf(std::span<const MarkPair> pairs) {
  const PlaneMotion guess = fitMotion(pairs, 0.0);
  const auto rows = static_cast<Index>(2 * pairs.size());
  Eigen::MatrixXd jacobian(rows, 3);
  Eigen::VectorXd miss(rows);
  Eigen::VectorXd variance(rows);
  Vector2d middle = Vector2d::Zero();
  for (const MarkPair& pair : pairs) middle += pair.p_mm / static_cast<double>(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto at = static_cast<Index>(2 * i);
    const Vector2d arm = guess.rotation() * (pairs[i].p_mm - middle);
    jacobian.middleRows<2>(at) << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    miss.segment<2>(at) = pairs[i].q_mm - guess * pairs[i].p_mm;
    variance.segment<2>(at).setConstant(pairs[i].sigma_mm * pairs[i].sigma_mm);
  }
  const Eigen::MatrixXd weighted = variance.cwiseInverse().asDiagonal() * jacobian;
  const Eigen::Matrix3d normal = jacobian.transpose() * weighted;
  const Eigen::MatrixXd spread = normal.ldlt().solve(jacobian.transpose());
  const Eigen::Vector3d step = normal.ldlt().solve(weighted.transpose() * miss);
  return {miss - jacobian * step, Eigen::MatrixXd(variance.asDiagonal()) - jacobian * spread};
}

}  // namespace

std::optional<MarkMisfit> worstMisfit(std::span<const MarkPair> pairs, double chance) {
  if (pairs.size() < 2) throw std::invalid_argument("a misfit needs at least two marks");
  if (!(chance > 0.0 && chance < 1.0)) throw std::invalid_argument("a chance lies between 0 and 1");
  if (!std::ranges::all_of(pairs, [](const MarkPair& pair) { return pair.sigma_mm > 0.0; }))
    throw std::invalid_argument("a misfit needs the uncertainty of each mark");
  const Residuals residuals = residualsOf(pairs);
  const double limit = chiSquareOf(pairs.size(), pairs.size() == 2 ? 1 : 2, chance);
  double worst = limit;
  std::optional<MarkMisfit> misfit;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto at = static_cast<Index>(2 * i);
    const Vector2d miss = residuals.mm.segment<2>(at);
    const Matrix2d covariance = residuals.covariance.block<2, 2>(at, at);
    // Two marks have one redundant direction alone: there the covariance has no inverse.
    Eigen::CompleteOrthogonalDecomposition<Matrix2d> decomposed;
    decomposed.setThreshold(1e-9);
    decomposed.compute(covariance);
    const Vector2d scaled = decomposed.solve(miss);
    const double chi_square = miss.dot(scaled);
    if (chi_square <= worst) continue;
    worst = chi_square;
    const double off_mm = pairs[i].sigma_mm * pairs[i].sigma_mm * scaled.norm();
    misfit = {i, off_mm, off_mm * std::sqrt(limit / chi_square)};
  }
  return misfit;
}

}  // namespace kerfbench::vision

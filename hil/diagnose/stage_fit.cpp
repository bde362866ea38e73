// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/stage_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace kerfbench::diagnose {
namespace {

/// Prior of a size that is to be found, over its own weight: none to speak of, and no division by 0.
constexpr double kRidge = 1e-9;

}  // namespace

Hypothesis both(const Hypothesis& a, const Hypothesis& b) {
  Hypothesis sum = a;
  sum.key += "+" + b.key;
  sum.free.insert(sum.free.end(), b.free.begin(), b.free.end());
  sum.fixed.insert(sum.fixed.end(), b.fixed.begin(), b.fixed.end());
  return sum;
}

StageFit::StageFit(std::vector<Row> rows, std::vector<Signature> signatures)
    : rows_(std::move(rows)), signatures_(std::move(signatures)) {
  const auto m = static_cast<Eigen::Index>(rows_.size());
  const auto n = static_cast<Eigen::Index>(signatures_.size());
  Eigen::MatrixXd columns(m, n);
  Eigen::VectorXd y(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    y(i) = row.y_mm / row.sigma_mm;
    for (Eigen::Index k = 0; k < n; ++k)
      columns(i, k) = signatures_[static_cast<std::size_t>(k)].of(row) / row.sigma_mm;
  }
  normal_ = columns.transpose() * columns;
  against_ = columns.transpose() * y;
  square_ = y.squaredNorm();
}

std::size_t StageFit::indexOf(const std::string& key) const {
  const auto found = std::ranges::find(signatures_, key, &Signature::key);
  return static_cast<std::size_t>(found - signatures_.begin());
}

std::vector<double> StageFit::left(const Fit& fit) const {
  std::vector<double> left;
  left.reserve(rows_.size());
  for (const Row& row : rows_) {
    double rest_mm = row.y_mm;
    for (std::size_t k = 0; k < signatures_.size(); ++k)
      if (const double size = fit.size(static_cast<Eigen::Index>(k)); size != 0.0)
        rest_mm -= size * signatures_[k].of(row);
    left.push_back(rest_mm / row.sigma_mm);
  }
  return left;
}

Fit StageFit::fit(const Hypothesis& hypothesis) const {
  const auto n = static_cast<Eigen::Index>(signatures_.size());
  Eigen::VectorXd against = against_;
  double square = square_;
  Fit fit;
  fit.size = Eigen::VectorXd::Zero(n);
  for (const auto& [key, size] : hypothesis.fixed) {
    const auto k = static_cast<Eigen::Index>(indexOf(key));
    if (k >= n) continue;
    square += size * size * normal_(k, k) - 2.0 * size * against(k);
    against -= size * normal_.col(k);
    fit.size(k) += size;
  }
  std::vector<Eigen::Index> taken;
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Signature& signature = signatures_[static_cast<std::size_t>(k)];
    const bool is_free = std::ranges::find(hypothesis.free, signature.key) != hypothesis.free.end();
    if (!is_free && !(signature.usual > 0.0)) continue;
    if (!(normal_(k, k) > 0.0)) continue;
    taken.push_back(k);
    if (is_free) ++fit.parameters;
    prior(k) = is_free ? kRidge * normal_(k, k) : 1.0 / (signature.usual * signature.usual);
  }
  const auto size = static_cast<Eigen::Index>(taken.size());
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  fit.chi_square = square;
  if (size == 0) return fit;
  Eigen::MatrixXd normal(size, size);
  Eigen::VectorXd right(size);
  Eigen::VectorXd scale(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    right(i) = against(taken[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < size; ++k)
      normal(i, k) = normal_(taken[static_cast<std::size_t>(i)], taken[static_cast<std::size_t>(k)]);
    normal(i, i) += prior(taken[static_cast<std::size_t>(i)]);
    scale(i) = 1.0 / std::sqrt(normal(i, i));
  }
  // Columns of very different units: scaled to 1 first.
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> solver(scaled);
  const Eigen::VectorXd found = scale.asDiagonal() * solver.solve(scale.asDiagonal() * right);
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * solver.solve(Eigen::MatrixXd::Identity(size, size)) * scale.asDiagonal();
  fit.chi_square = square - right.dot(found);
  for (Eigen::Index i = 0; i < size; ++i) {
    fit.size(taken[static_cast<std::size_t>(i)]) += found(i);
    for (Eigen::Index k = 0; k < size; ++k)
      fit.covariance(taken[static_cast<std::size_t>(i)], taken[static_cast<std::size_t>(k)]) =
          covariance(i, k);
  }
  return fit;
}

}  // namespace kerfbench::diagnose

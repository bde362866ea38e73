// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/line_smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace kerfbench::hil {
namespace {

constexpr double kInterval = 3.0;
constexpr std::size_t kFewest = 5;  // Readings for a parabola that is more than an interpolation.

/// Weights of the readings -left … right in the value at 0 of the parabola through them.
std::vector<double> parabolaWeights(std::size_t left, std::size_t right) {
  const auto n = static_cast<Eigen::Index>(left + right + 1);
  if (n == 1) return {1.0};
  Eigen::MatrixX3d A(n, 3);
  const double scale = 1.0 / static_cast<double>(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double x = scale * (static_cast<double>(j) - static_cast<double>(left));
    A.row(j) << 1.0, x, x * x;
  }
  const Eigen::Vector3d first = (A.transpose() * A).ldlt().solve(Eigen::Vector3d::UnitX());
  const Eigen::VectorXd weights = A * first;
  return {weights.begin(), weights.end()};
}

}  // namespace

const std::vector<double>& LineSmoother::weightsFor(std::size_t left, std::size_t right) {
  auto [at, is_new] = weights_.try_emplace({left, right});
  if (is_new) at->second = parabolaWeights(left, right);
  return at->second;
}

LineSmoother::LineSmoother(const ReadingLine& line) : line_(line), levels_(line.size(), 1) {
  for (auto& windows : window_) windows.resize(line.size());
  for (auto& sigmas : sigma_mm_) sigmas.resize(line.size());
  for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
    for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i) {
      for (std::size_t k = 0; k < kHalf.size(); ++k) {
        const std::size_t left = std::min(kHalf[k], i - line.segment[s]);
        const std::size_t right = std::min(kHalf[k], line.segment[s + 1] - 1 - i);
        if (k > 0 && left + right + 1 < kFewest) break;
        window_[k][i] = {i - left, &weightsFor(left, right)};
        sigma_mm_[k][i] = std::sqrt(covariance(window_[k][i], window_[k][i]));
        levels_[i] = static_cast<std::uint8_t>(k + 1);
      }
    }
  }
}

double LineSmoother::apply(const Window& window, const std::vector<double>& reading_mm) {
  const auto n = static_cast<Eigen::Index>(window.weight->size());
  return Eigen::Map<const Eigen::VectorXd>(window.weight->data(), n)
      .dot(Eigen::Map<const Eigen::VectorXd>(reading_mm.data() + window.first, n));
}

/// Of two estimates: sum of w_j sigma_j w_k sigma_k q^|j - k|. Two running sums, one from each end, hold what
/// all readings of b on that side have in common with a reading of a.
double LineSmoother::covariance(const Window& a, const Window& b) const {
  const std::size_t begin = std::min(a.first, b.first);
  const std::size_t end = std::max(a.first + a.weight->size(), b.first + b.weight->size());
  const auto term = [&](const Window& w, std::size_t i) {
    return i < w.first || i >= w.first + w.weight->size() ? 0.0
                                                          : (*w.weight)[i - w.first] * line_.sigma_mm[i];
  };
  double sum = 0.0;
  double behind = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    behind = behind * line_.q + term(b, i);
    sum += term(a, i) * behind;
  }
  double ahead = 0.0;
  for (std::size_t i = end; i-- > begin;) {
    sum += term(a, i) * ahead * line_.q;
    ahead = ahead * line_.q + term(b, i);
  }
  return sum;
}

void LineSmoother::smooth(const std::vector<double>& reading_mm, std::vector<double>& estimate_mm,
                          std::vector<std::uint8_t>* level) const {
  estimate_mm.resize(line_.size());
  if (level != nullptr) level->resize(line_.size());
  for (std::size_t i = 0; i < line_.size(); ++i) {
    double low = -std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::uint8_t k = 0; k < levels_[i]; ++k) {
      const double estimate = apply(window_[k][i], reading_mm);
      low = std::max(low, estimate - kInterval * sigma_mm_[k][i]);
      high = std::min(high, estimate + kInterval * sigma_mm_[k][i]);
      if (k > 0 && !(low <= high)) break;
      estimate_mm[i] = estimate;
      if (level != nullptr) (*level)[i] = k;
    }
  }
}

void LineSmoother::apply(const std::vector<double>& reading_mm, const std::vector<std::uint8_t>& level,
                         std::vector<double>& estimate_mm) const {
  estimate_mm.resize(line_.size());
  for (std::size_t i = 0; i < line_.size(); ++i) estimate_mm[i] = apply(window_[level[i]][i], reading_mm);
}

double LineSmoother::correlationWithPrevious(std::size_t reading,
                                             const std::vector<std::uint8_t>& level) const {
  const double both = sigma(reading, level[reading]) * sigma(reading - 1, level[reading - 1]);
  const double c =
      covariance(window_[level[reading]][reading], window_[level[reading - 1]][reading - 1]) / both;
  return std::clamp(c, 0.0, 1.0);
}

}  // namespace kerfbench::hil

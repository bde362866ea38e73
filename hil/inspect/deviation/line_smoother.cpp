// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/line_smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "twin/base/multiversion.h"

namespace kerfbench::inspect {
namespace {

constexpr double kInterval = 2.5;
constexpr double kScatter = 3.0;    // Standard deviations of the scatter that pass for noise.
constexpr std::size_t kFewest = 5;  // Readings for a parabola that is more than an interpolation.

/// Sums of readings by their weights, of all draws.
KERFBENCH_WIDE void addWeighted(const double* weight, std::size_t count, const LineSmoother::Draws* reading,
                                LineSmoother::Draws& out) {
  LineSmoother::Draws sum{};
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t d = 0; d < sum.size(); ++d) sum[d] += weight[j] * reading[j][d];
  }
  out = sum;
}

}  // namespace

const LineSmoother::Kernel& LineSmoother::Kernels::kernelFor(double q, std::size_t left, std::size_t right) {
  const std::scoped_lock lock(mutex_);
  const auto [at, is_new] = kernels_.try_emplace({q, left, right});
  Kernel& kernel = at->second;
  if (!is_new) return kernel;
  const auto n = static_cast<Eigen::Index>(left + right + 1);
  kernel.weight = {1.0};
  if (n == 1) return kernel;
  Eigen::MatrixX3d A(n, 3);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double x = (static_cast<double>(j) - static_cast<double>(left)) / static_cast<double>(n);
    A.row(j) << 1.0, x, x * x;
  }
  const Eigen::Matrix3Xd solve = (A.transpose() * A).ldlt().solve(A.transpose());
  const Eigen::VectorXd weights = solve.row(0);
  kernel.weight.assign(weights.begin(), weights.end());
  kernel.rest = Eigen::MatrixXd::Identity(n, n) - A * solve;
  // The trace of rest R rest^T, R being the correlations q^|j - k|: the rest's own rest is itself.
  double correlation = 1.0;
  for (Eigen::Index apart = 0; apart < n; ++apart, correlation *= q)
    kernel.expected_rest += (apart == 0 ? 1.0 : 2.0) * correlation * kernel.rest.diagonal(apart).sum();
  kernel.expected_rest /= static_cast<double>(n);
  return kernel;
}

bool LineSmoother::fits(const Window& window, const std::vector<double>& reading_mm) const {
  const auto n = static_cast<Eigen::Index>(window.kernel->weight.size());
  if (n == 1) return true;
  const Eigen::Map<const Eigen::VectorXd> reading(reading_mm.data() + window.first, n);
  const Eigen::Map<const Eigen::VectorXd> sigma(line_.sigma_mm.data() + window.first, n);
  const double scatter = (window.kernel->rest * reading).squaredNorm() / sigma.squaredNorm();
  // With correlation fewer of them are free.
  const double free = static_cast<double>(n - 3) * (1.0 - line_.q) / (1.0 + line_.q);
  return scatter <= window.kernel->expected_rest * (1.0 + kScatter * std::sqrt(2.0 / std::max(free, 2.0)));
}

LineSmoother::LineSmoother(const ReadingLine& line, std::shared_ptr<Kernels> kernels)
    : line_(line),
      kernels_(kernels ? std::move(kernels) : std::make_shared<Kernels>()),
      levels_(line.size(), 1) {
  for (auto& windows : window_) windows.resize(line.size());
  for (auto& sigmas : sigma_mm_) sigmas.resize(line.size());
  for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
    for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i) {
      for (std::size_t k = 0; k < kHalf.size(); ++k) {
        const std::size_t left = std::min(kHalf[k], i - line.segment[s]);
        const std::size_t right = std::min(kHalf[k], line.segment[s + 1] - 1 - i);
        if (k > 0 && left + right + 1 < kFewest) break;
        window_[k][i] = {i - left, &kernels_->kernelFor(line_.q, left, right)};
        sigma_mm_[k][i] = std::sqrt(covariance(window_[k][i], window_[k][i]));
        levels_[i] = static_cast<std::uint8_t>(k + 1);
      }
    }
  }
}

double LineSmoother::apply(const Window& window, const std::vector<double>& reading_mm) {
  const auto n = static_cast<Eigen::Index>(window.kernel->weight.size());
  return Eigen::Map<const Eigen::VectorXd>(window.kernel->weight.data(), n)
      .dot(Eigen::Map<const Eigen::VectorXd>(reading_mm.data() + window.first, n));
}

/// Covariance of two estimates: sum of w_j sigma_j w_k sigma_k q^|j - k|. Two running sums, one from each
/// end, hold what all readings of b on that side have in common with a reading of a.
double LineSmoother::covariance(const Window& a, const Window& b) const {
  const std::size_t begin = std::min(a.first, b.first);
  const std::size_t end = std::max(a.first + a.kernel->weight.size(), b.first + b.kernel->weight.size());
  const auto term = [&](const Window& w, std::size_t i) {
    return i < w.first || i >= w.first + w.kernel->weight.size()
               ? 0.0
               : w.kernel->weight[i - w.first] * line_.sigma_mm[i];
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
      if (k > 0 && (!(low <= high) || !fits(window_[k][i], reading_mm))) break;
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

void LineSmoother::apply(const std::vector<Draws>& reading_mm, const std::vector<std::uint8_t>& level,
                         std::vector<Draws>& estimate_mm) const {
  estimate_mm.resize(line_.size());
  for (std::size_t i = 0; i < line_.size(); ++i) {
    const Window& window = window_[level[i]][i];
    const std::vector<double>& weight = window.kernel->weight;
    addWeighted(weight.data(), weight.size(), reading_mm.data() + window.first, estimate_mm[i]);
  }
}

double LineSmoother::correlationWithPrevious(std::size_t reading,
                                             const std::vector<std::uint8_t>& level) const {
  const double both = sigma(reading, level[reading]) * sigma(reading - 1, level[reading - 1]);
  const double c =
      covariance(window_[level[reading]][reading], window_[level[reading - 1]][reading - 1]) / both;
  return std::clamp(c, 0.0, 1.0);
}

}  // namespace kerfbench::inspect

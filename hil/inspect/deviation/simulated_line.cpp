// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/simulated_line.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/QR>

#include "twin/base/multiversion.h"
#include "twin/base/normals.h"

namespace kerfbench::inspect {
namespace {

/// Offset, slope, bend and one turn of a sine: what a shift, a turn, a scale and a wrong centre make.
Eigen::MatrixXd trendBasis(std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd basis(n, 5);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = n > 1 ? 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0 : 0.0;
    const double angle = std::numbers::pi * t;
    basis.row(i) << 1.0, t, t * t, std::cos(angle), std::sin(angle);
  }
  return basis.leftCols(std::min<Eigen::Index>(5, n));
}

/// What the shared errors make of the readings: a row of weights for each, a weight for each error.
KERFBENCH_WIDE void addShared(std::span<const double> weights, std::span<const Draws> errors,
                              std::span<Draws> shift) {
  for (std::size_t i = 0; i < shift.size(); ++i) {
    Draws sum{};
    for (std::size_t k = 0; k < errors.size(); ++k) {
      const double weight = weights[i * errors.size() + k];
      for (std::size_t d = 0; d < sum.size(); ++d) sum[d] += weight * errors[k][d];
    }
    shift[i] = sum;
  }
}

}  // namespace

double largestOf(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values)
    most = v != v ? std::numeric_limits<double>::quiet_NaN() : std::max(most, std::abs(v));
  return most;
}

double sumOfSquares(const std::vector<double>& values, LineKind::Rms about) {
  if (values.empty()) return 0.0;
  double sum = 0.0;
  double mean = 0.0;
  for (const double v : values) {
    sum += v * v;
    mean += v / static_cast<double>(values.size());
  }
  return about == LineKind::Rms::kAboutZero ? sum : sum - mean * mean * static_cast<double>(values.size());
}

double errorSquaresOf(const ReadingLine& line) {
  double sum = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    sum += line.sigma_mm[i] * line.sigma_mm[i] + line.shared.row(static_cast<Eigen::Index>(i)).squaredNorm();
  }
  return sum;
}

Draws largestOf(std::span<const Draws> values) {
  Draws most{};
  for (const Draws& value : values) {
    for (std::size_t d = 0; d < most.size(); ++d)
      most[d] = std::isnan(value[d]) ? value[d] : std::max(most[d], std::abs(value[d]));  // A NaN stays.
  }
  return most;
}

Draws sumOfSquares(std::span<const Draws> values, LineKind::Rms about) {
  Draws sum{};
  Draws mean{};
  if (values.empty()) return sum;
  const auto count = static_cast<double>(values.size());
  for (const Draws& value : values) {
    for (std::size_t d = 0; d < sum.size(); ++d) {
      sum[d] += value[d] * value[d];
      mean[d] += value[d] / count;
    }
  }
  if (about == LineKind::Rms::kAboutZero) return sum;
  for (std::size_t d = 0; d < sum.size(); ++d) sum[d] -= mean[d] * mean[d] * count;
  return sum;
}

SimulatedLine::SimulatedLine(const ReadingLine& line, const LineKind& kind,
                             std::shared_ptr<LineSmoother::Kernels> kernels)
    : rms(kind.rms), line_(line), smoother_(line, std::move(kernels)) {
  for (Eigen::Index k = 0; k < line.shared.cols(); ++k) {
    if ((line.shared.col(k).array() != 0.0).any()) columns_.push_back(k);
  }
  weights_.reserve(columns_.size() * line.size());
  for (Eigen::Index i = 0; i < line.shared.rows(); ++i) {
    for (const Eigen::Index k : columns_) weights_.push_back(line.shared(i, k));
  }

  smoother_.smooth(line.reading_mm, estimate_mm, &level);
  likely_mm = likelyTruth();
  if (kind.is_circle && kind.angle_rad.size() == line.size()) {
    roundness_.emplace(line, kind.angle_rad, kind.window_rad);
    if (!roundness_->isKnown()) roundness_.reset();
  }
}

std::vector<double> SimulatedLine::likelyTruth() {
  const std::size_t n = line_.size();
  if (n == 0) return {};
  const Eigen::MatrixXd basis = trendBasis(n);
  const Eigen::Map<const Eigen::VectorXd> estimate(estimate_mm.data(), static_cast<Eigen::Index>(n));
  const Eigen::VectorXd trend = basis * basis.colPivHouseholderQr().solve(estimate);
  double by_noise = 0.0;
  for (std::size_t i = 0; i < n; ++i) by_noise += std::pow(smoother_.sigma(i, level[i]), 2);
  const double scatter = (estimate - trend).squaredNorm();
  noise_share = scatter > by_noise ? 1.0 - by_noise / scatter : 0.0;
  const Eigen::VectorXd likely = trend + std::sqrt(noise_share) * (estimate - trend);
  return {likely.begin(), likely.end()};
}

void SimulatedLine::measure(std::span<const CounterRandom, kDrawsAtOnce> noise, std::uint64_t first,
                            std::span<const Draws> shared_error, SimulatedReadings& into) const {
  const std::size_t n = line_.size();
  into.reading_mm.resize(n);
  into.shift_mm.resize(n);
  into.noise.resize(kDrawsAtOnce * n);
  addShared(weights_, shared_error, into.shift_mm);
  for (std::size_t d = 0; d < kDrawsAtOnce; ++d)
    fillNormals(noise[d], first, std::span(into.noise).subspan(d * n, n));
  const double innovation = std::sqrt(1.0 - line_.q * line_.q);
  for (std::size_t s = 0; s + 1 < line_.segment.size(); ++s) {
    const std::size_t begin = line_.segment[s];
    Draws z{};
    for (std::size_t i = begin; i < line_.segment[s + 1]; ++i) {
      for (std::size_t d = 0; d < kDrawsAtOnce; ++d) {
        const double drawn = into.noise[d * n + i];
        z[d] = i == begin ? drawn : line_.q * z[d] + innovation * drawn;
        into.reading_mm[i][d] = likely_mm[i] + line_.sigma_mm[i] * z[d] + into.shift_mm[i][d];
      }
    }
  }
  smoother_.apply(into.reading_mm, level, into.simulated_mm);
}

std::vector<double> SimulatedLine::seen() const {
  std::vector<double> seen_mm;
  smoother_.apply(likely_mm, level, seen_mm);
  return seen_mm;
}

double SimulatedLine::errorAt(std::size_t reading) const {
  return std::hypot(smoother_.sigma(reading, level[reading]),
                    line_.shared.row(static_cast<Eigen::Index>(reading)).norm());
}

double SimulatedLine::errorShareAt(std::size_t reading) const {
  const double noise = std::pow(smoother_.sigma(reading, level[reading]), 2);
  // The camera's errors move all alike.
  const double shared = line_.shared.row(static_cast<Eigen::Index>(reading))
                            .head(ReadingLine::kOwn + line_.tileColumns())
                            .squaredNorm();
  return noise + shared > 0.0 ? (noise_share * noise + shared) / (noise + shared) : 1.0;
}

}  // namespace kerfbench::inspect

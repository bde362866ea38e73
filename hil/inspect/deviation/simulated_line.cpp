// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/simulated_line.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/QR>

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

/// Standard normal values, two from each pair of uniform ones (Box and Muller).
void normals(const CounterRandom& random, std::uint64_t first, std::vector<double>& out) {
  for (std::size_t i = 0; i < out.size(); i += 2) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform(first + i)));
    const double angle = 2.0 * std::numbers::pi * random.uniform(first + i + 1);
    out[i] = radius * std::cos(angle);
    if (i + 1 < out.size()) out[i + 1] = radius * std::sin(angle);
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

SimulatedLine::SimulatedLine(const ReadingLine& line, const LineKind& kind)
    : rms(kind.rms), line_(line), smoother_(line), noise_(line.size()) {
  smoother_.smooth(line.reading_mm, estimate_mm, &level);
  likely_mm = likelyTruth();
  if (kind.is_circle && kind.angle_rad.size() == line.size()) {
    roundness_.emplace(line, kind.angle_rad, kind.window_rad);
    if (!roundness_->isKnown()) roundness_.reset();
  }
  for (std::size_t i = 0; i < line.size(); ++i) {
    error_squares +=
        line.sigma_mm[i] * line.sigma_mm[i] + line.shared.row(static_cast<Eigen::Index>(i)).squaredNorm();
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

void SimulatedLine::measure(const CounterRandom& noise, std::uint64_t first,
                            const Eigen::VectorXd& shared_error) {
  const Eigen::VectorXd shift = line_.shared * shared_error;
  const double innovation = std::sqrt(1.0 - line_.q * line_.q);
  normals(noise, first, noise_);
  reading_mm.resize(line_.size());
  for (std::size_t s = 0; s + 1 < line_.segment.size(); ++s) {
    double z = 0.0;
    for (std::size_t i = line_.segment[s]; i < line_.segment[s + 1]; ++i) {
      z = i == line_.segment[s] ? noise_[i] : line_.q * z + innovation * noise_[i];
      reading_mm[i] = likely_mm[i] + line_.sigma_mm[i] * z + shift[static_cast<Eigen::Index>(i)];
    }
  }
  smoother_.apply(reading_mm, level, simulated_mm);
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
                            .head(ReadingLine::kOwn + line_.tiles)
                            .squaredNorm();
  return noise + shared > 0.0 ? (noise_share * noise + shared) / (noise + shared) : 1.0;
}

}  // namespace kerfbench::inspect

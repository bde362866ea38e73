// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/roundness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/QR>

namespace kerfbench::inspect {
namespace {

constexpr Eigen::Index kCircle = 3;  // Size and centre.
constexpr Eigen::Index kSeam = 2;    // Step and kink.
constexpr double kPenalty = 2.0;     // Price of a coefficient, in its noise (Mallows).
constexpr double kBeyondSeam =
    0.1;                         // Share of a reading next to it, what a kerf's round end brings from there.
constexpr double kBelief = 6.0;  // Coefficients worth, in what the calipers say of their noise.

Eigen::Index columnsOf(int order) { return kCircle + kSeam + 2 * (order - 1); }
/// First of a wave's two.
Eigen::Index columnOf(int wave) { return columnsOf(wave) - 2; }

double widestGap(std::vector<double> angle_rad) {
  const double turn = 2.0 * std::numbers::pi;
  for (double& a : angle_rad) a -= turn * std::floor(a / turn);
  std::sort(angle_rad.begin(), angle_rad.end());
  double widest = angle_rad.front() + turn - angle_rad.back();
  for (std::size_t i = 1; i < angle_rad.size(); ++i)
    widest = std::max(widest, angle_rad[i] - angle_rad[i - 1]);
  return widest;
}

/// Four readings and more to the wave, and two gaps: what is between is not made up.
int mostWaves(const std::vector<double>& angle_rad) {
  if (angle_rad.size() < 8) return 0;
  const double by_gap = std::numbers::pi / widestGap(angle_rad);
  return static_cast<int>(std::min(by_gap, 0.25 * static_cast<double>(angle_rad.size())));
}

/// Readings at each end whose windows reach over the seam: they see both sides of a step.
std::size_t atSeam(const std::vector<double>& angle_rad, double window_rad) {
  std::size_t count = 0;
  while (count < angle_rad.size() && std::abs(std::remainder(angle_rad[count] - angle_rad.front(),
                                                             2.0 * std::numbers::pi)) < 0.49 * window_rad)
    ++count;
  return count;
}

/// What of a wave is left of noise that a window averages: sin x / x, x being half of the window in its
/// phase.
double throughWindow(double x) { return x < 1e-6 ? 1.0 : std::sin(x) / x; }

/// Columns: size, centre, step and kink where the line closes (a ramp and a parabola around the circle), and
/// two for each wave from 2 to the turn on.
Eigen::MatrixXd wavesOf(const std::vector<double>& angle_rad, int order) {
  Eigen::MatrixXd waves(static_cast<Eigen::Index>(angle_rad.size()), columnsOf(order));
  double turned_rad = 0.0;
  for (Eigen::Index i = 0; i < waves.rows(); ++i) {
    const double angle = angle_rad[static_cast<std::size_t>(i)];
    if (i > 0)
      turned_rad +=
          std::remainder(angle - angle_rad[static_cast<std::size_t>(i - 1)], 2.0 * std::numbers::pi);
    waves.row(i).head<kCircle + kSeam>() << 1.0, std::cos(angle), std::sin(angle), turned_rad,
        turned_rad * turned_rad;
    for (int k = Roundness::kLeastOrder; k <= order; ++k)
      waves.row(i).segment<2>(columnOf(k)) << std::cos(k * angle), std::sin(k * angle);
  }
  return waves;
}

}  // namespace

/// Mean square of the coefficients from `first` on, as it would be of slow waves: they hold noise alone.
double Roundness::noiseFrom(const Eigen::VectorXd& coefficient, Eigen::Index first, double expected) const {
  const Eigen::Index left = coefficient.size() - first;
  return (kBelief * expected + coefficient.tail(left).cwiseQuotient(through_.tail(left)).squaredNorm()) /
         (kBelief + static_cast<double>(left));
}

/// The gain in expected error by one more wave is its power less twice its noise.
void Roundness::chooseOrder(const Eigen::VectorXd& coefficient, int most, double noise) {
  double gain = 0.0;
  double best = -std::numeric_limits<double>::infinity();
  for (int k = kLeastOrder; k <= most; ++k) {
    const double own = noise * through_[columnOf(k)] * through_[columnOf(k)];
    gain += coefficient.segment<2>(columnOf(k)).squaredNorm() - 2.0 * kPenalty * own;
    if (gain > best) {
      best = gain;
      order_ = k;
    }
  }
}

/// Draws each wave in by what noise is likely to have added to it.
void Roundness::findLikely(const Eigen::VectorXd& coefficient) {
  likely_of_ = coefficient;
  const double noise = noise_mm_ * noise_mm_;
  double held = 0.0;
  const auto drawIn = [&](Eigen::Index first, Eigen::Index count) {
    const double power = coefficient.segment(first, count).squaredNorm();
    const double by_noise = static_cast<double>(count) * noise;
    const double share = power > by_noise ? 1.0 - by_noise / power : 0.0;
    likely_of_.segment(first, count) *= std::sqrt(share);
    held += share * by_noise;
  };
  drawIn(kCircle, kSeam);
  for (int k = kLeastOrder; k <= order_; ++k) drawIn(columnOf(k), 2);
  noise_share_ = held / (static_cast<double>(coefficient.size() - kCircle) * noise);
}

Roundness::Roundness(const ReadingLine& line, const std::vector<double>& angle_rad, double window_rad)
    : skipped_(atSeam(angle_rad, window_rad)) {
  if (2 * skipped_ >= angle_rad.size()) return;
  const auto skipped = static_cast<std::ptrdiff_t>(skipped_);
  const int most = mostWaves({angle_rad.begin() + skipped, angle_rad.end() - skipped});
  if (most < kLeastOrder) return;
  const Eigen::MatrixXd everywhere = wavesOf(angle_rad, most);
  const Eigen::Index inner = everywhere.rows() - 2 * skipped;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(everywhere.middleRows(skipped, inner));
  basis_ = qr.householderQ() * Eigen::MatrixXd::Identity(inner, everywhere.cols());
  through_ = Eigen::VectorXd::Ones(everywhere.cols());
  for (int k = kLeastOrder; k <= most; ++k)
    through_.segment<2>(columnOf(k)).setConstant(throughWindow(0.5 * k * window_rad));

  const Eigen::Map<const Eigen::VectorXd> reading(line.reading_mm.data() + skipped, inner);
  const Eigen::Map<const Eigen::VectorXd> sigma(line.sigma_mm.data() + skipped, inner);
  const Eigen::VectorXd coefficient = basis_.transpose() * reading;
  const double stated = sigma.squaredNorm() / static_cast<double>(inner);
  const double fine = noiseFrom(coefficient, columnsOf(std::max(kLeastOrder, 2 * most / 3)), stated);
  chooseOrder(coefficient, most, fine);
  const Eigen::Index columns = columnsOf(order_);
  noise_mm_ = std::sqrt(noiseFrom(coefficient, columns, fine));
  basis_ = basis_.leftCols(columns).eval();
  // What the fit is at all readings, those at the seam too: the circle goes through all of them.
  Eigen::MatrixXd fit = qr.matrixQR()
                            .topLeftCorner(columns, columns)
                            .triangularView<Eigen::Upper>()
                            .solve<Eigen::OnTheRight>(everywhere.leftCols(columns));
  const Eigen::MatrixXd circle = everywhere.leftCols<kCircle>();
  fit -= circle * circle.householderQr().solve(fit);
  radius_ = fit.middleRows(skipped, inner);
  step_mm_ = (fit.row(fit.rows() - 1) - fit.row(0)).dot(coefficient.head(columns));
  findLikely(coefficient.head(columns));
  as_read_mm_ = rangeOf(coefficient.head(columns));
  likely_mm_ = rangeOf(likely_of_);
}

double Roundness::rangeOf(const Eigen::VectorXd& coefficient) const {
  const Eigen::VectorXd radius = radius_ * coefficient;
  return radius.maxCoeff() - radius.minCoeff();
}

double Roundness::unfittedSigma() const {
  const double amplitude_mm = noise_mm_ * std::sqrt(4.0 * kPenalty / static_cast<double>(basis_.rows()));
  return amplitude_mm * std::sqrt(2.0 / 3.0);
}

double Roundness::seamSigma() const { return kBeyondSeam / std::sqrt(3.0) * std::abs(step_mm_); }

LineSmoother::Draws Roundness::simulated(std::span<const CounterRandom, LineSmoother::kDrawsAtOnce> random,
                                         std::span<const LineSmoother::Draws> shift_mm) const {
  using Sample = Eigen::Matrix<double, Eigen::Dynamic, LineSmoother::kDrawsAtOnce, Eigen::RowMajor>;
  const Eigen::Map<const Sample> shift(shift_mm[skipped_].data(), basis_.rows(), Sample::ColsAtCompileTime);
  Sample coefficient = basis_.transpose() * shift;
  coefficient.colwise() += likely_of_;
  for (Eigen::Index j = kCircle; j < coefficient.rows(); ++j) {
    for (Eigen::Index d = 0; d < coefficient.cols(); ++d)
      coefficient(j, d) +=
          noise_mm_ * random[static_cast<std::size_t>(d)].normal(static_cast<std::uint64_t>(j));
  }
  const Sample radius = radius_ * coefficient;
  LineSmoother::Draws range{};
  Eigen::Map<Eigen::RowVector<double, Sample::ColsAtCompileTime>>(range.data()) =
      radius.colwise().maxCoeff() - radius.colwise().minCoeff();
  return range;
}

}  // namespace kerfbench::inspect

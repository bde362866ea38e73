// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot_fit.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace kerfbench::hil {
namespace {

constexpr int kMaxHalfWindow = 96;
constexpr int kSaturated = 254;
constexpr double kEdgeSigmaPx = 0.7;

// x, y, the inverse covariance a b c, height, board, ink.
constexpr int kParameters = 8;
using Vector = Eigen::Matrix<double, kParameters, 1>;
using Matrix = Eigen::Matrix<double, kParameters, kParameters>;

struct Window {
  int left, top, right, bottom;  // inclusive
  [[nodiscard]] int width() const { return right - left + 1; }
  [[nodiscard]] int height() const { return bottom - top + 1; }
};

struct Start {
  Window window;
  Vector parameters;
};

/// The picture as if nothing were printed.
double withoutPrint(const GrayImage& image, int c, int r, std::span<const DiscInPicture> discs) {
  double value = image.gray(c, r);
  for (const DiscInPicture& disc : discs) value += disc.contrast_gray * coverOf(disc, Eigen::Vector2d(c, r));
  return value;
}

/// The bright region around the peak tells size and direction to start from.
std::optional<Start> growRegion(const GrayImage& image, const BrightPeak& peak, double board, double noise,
                                std::span<const DiscInPicture> discs) {
  const double floor_gray = board + std::max(3.0 * noise, 0.2 * static_cast<double>(peak.height));
  const Window limit{std::max(0, peak.column - kMaxHalfWindow), std::max(0, peak.row - kMaxHalfWindow),
                     std::min(image.width - 1, peak.column + kMaxHalfWindow),
                     std::min(image.height - 1, peak.row + kMaxHalfWindow)};
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(limit.width() * limit.height()), 0);
  std::vector<std::pair<int, int>> queue;
  const auto visit = [&](int c, int r) {
    if (c < limit.left || c > limit.right || r < limit.top || r > limit.bottom) return;
    auto& mark = seen[static_cast<std::size_t>((r - limit.top) * limit.width() + c - limit.left)];
    if (mark != 0) return;
    mark = 1;
    if (withoutPrint(image, c, r, discs) > floor_gray) queue.emplace_back(c, r);
  };
  for (int dr = 0; dr < 2; ++dr) {
    for (int dc = 0; dc < 2; ++dc) visit(peak.column + dc, peak.row + dr);
  }
  double weight = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  Window box{peak.column, peak.row, peak.column + 1, peak.row + 1};
  double top_gray = board;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const auto [c, r] = queue[i];
    const double value = withoutPrint(image, c, r, discs);
    const double w = value - board;
    const Eigen::Vector2d d(c - peak.column, r - peak.row);
    weight += w;
    first += w * d;
    second += w * d * d.transpose();
    box = {std::min(box.left, c), std::min(box.top, r), std::max(box.right, c), std::max(box.bottom, r)};
    top_gray = std::max(top_gray, value);
    visit(c - 1, r);
    visit(c + 1, r);
    visit(c, r - 1);
    visit(c, r + 1);
  }
  if (queue.size() < 2 || !(weight > 0.0)) return std::nullopt;
  const Eigen::Vector2d mean = first / weight;
  Eigen::Matrix2d shape = second / weight - mean * mean.transpose();
  shape += 0.4 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d inverse = shape.inverse();
  Start start;
  const int margin = 5;
  start.window = {std::max(0, box.left - margin), std::max(0, box.top - margin),
                  std::min(image.width - 1, box.right + margin),
                  std::min(image.height - 1, box.bottom + margin)};
  const double ink = discs.empty() ? 0.0 : -discs.front().contrast_gray;
  start.parameters << peak.column + mean.x(), peak.row + mean.y(), inverse(0, 0), inverse(0, 1),
      inverse(1, 1), top_gray - board, board, ink;
  return start;
}

struct Sums {
  Matrix normal = Matrix::Zero();
  Vector gradient = Vector::Zero();
  double cost{};
  int saturated{};
};

/// Model and its derivative by the parameters at one pixel.
struct PixelModel {
  double value;
  double bell;
  double dx;
  double dy;

  PixelModel(const Vector& q, double c, double r, double cover) : dx(c - q[0]), dy(r - q[1]) {
    const double exponent = 0.5 * (q[2] * dx * dx + 2.0 * q[3] * dx * dy + q[4] * dy * dy);
    bell = exponent < 30.0 ? std::exp(-exponent) : 0.0;
    value = q[5] * bell + q[6] + q[7] * cover;
  }
  [[nodiscard]] Vector derivative(const Vector& q, double cover) const {
    const double s = q[5] * bell;
    Vector j;
    j << s * (q[2] * dx + q[3] * dy), s * (q[3] * dx + q[4] * dy), -0.5 * s * dx * dx, -s * dx * dy,
        -0.5 * s * dy * dy, bell, 1.0, cover;
    return j;
  }
};

double coverAt(const std::vector<double>& cover, const Window& w, int c, int r) {
  return cover.empty() ? 0.0 : cover[static_cast<std::size_t>((r - w.top) * w.width() + c - w.left)];
}

Sums accumulate(const GrayImage& image, const Window& w, const std::vector<double>& cover, const Vector& q) {
  Sums sums;
  for (int r = w.top; r <= w.bottom; ++r) {
    for (int c = w.left; c <= w.right; ++c) {
      const double m = coverAt(cover, w, c, r);
      const PixelModel at(q, c, r, m);
      const double value = image.gray(c, r);
      if (value >= kSaturated &&
          at.value >= kSaturated) {  // As bright as it can be: agrees, and tells no more.
        ++sums.saturated;
        continue;
      }
      const double residual = value - std::min(at.value, 255.0);
      sums.cost += residual * residual;
      if (at.value > 255.0) continue;
      if (at.bell < 1e-5) {  // Plain board or ink: most pixels.
        sums.normal(6, 6) += 1.0;
        sums.normal(6, 7) += m;
        sums.normal(7, 6) += m;
        sums.normal(7, 7) += m * m;
        sums.gradient[6] += residual;
        sums.gradient[7] += residual * m;
        continue;
      }
      const Vector j = at.derivative(q, m);
      sums.normal.noalias() += j * j.transpose();
      sums.gradient += residual * j;
    }
  }
  return sums;
}

/// Covariance of the centre. A shape that is not quite Gaussian, as a streak's, leaves residuals that are
/// alike on both sides of the centre and do not move it; only what differs between mirrored pixels counts as
/// noise. Never less than the noise of the board, grown as shot noise grows with the light.
Eigen::Matrix2d centreCovariance(const GrayImage& image, const Window& w, const std::vector<double>& cover,
                                 const Vector& q, const Matrix& inverse, double noise) {
  const auto residualAt = [&](int c, int r) {
    const double model = PixelModel(q, c, r, coverAt(cover, w, c, r)).value;
    const double value = image.gray(c, r);
    return value >= kSaturated && model >= kSaturated ? 0.0 : value - std::min(model, 255.0);
  };
  Matrix seen = Matrix::Zero();
  Matrix shot = Matrix::Zero();
  for (int r = w.top; r <= w.bottom; ++r) {
    for (int c = w.left; c <= w.right; ++c) {
      const double m = coverAt(cover, w, c, r);
      const PixelModel at(q, c, r, m);
      if (at.bell < 1e-5 || at.value > 255.0) continue;
      const Vector j = at.derivative(q, m);
      const Matrix outer = j * j.transpose();
      shot += noise * noise * std::max(1.0, at.value / std::max(1.0, q[6])) * outer;
      const double mx = 2.0 * q[0] - c;
      const double my = 2.0 * q[1] - r;
      const int mc = static_cast<int>(std::floor(mx));
      const int mr = static_cast<int>(std::floor(my));
      double difference = residualAt(c, r);
      double parts = 1.0;
      if (mc >= w.left && mc < w.right && mr >= w.top && mr < w.bottom) {
        const double fx = mx - mc;
        const double fy = my - mr;
        for (const auto& [dc, dr, weight] :
             {std::tuple{0, 0, (1 - fx) * (1 - fy)}, std::tuple{1, 0, fx * (1 - fy)},
              std::tuple{0, 1, (1 - fx) * fy}, std::tuple{1, 1, fx * fy}}) {
          difference -= weight * residualAt(mc + dc, mr + dr);
          parts += weight * weight;
        }
      }
      seen += difference * difference / parts * outer;
    }
  }
  const Eigen::Matrix2d by_residuals = (inverse * seen * inverse).topLeftCorner<2, 2>();
  const Eigen::Matrix2d by_shot = (inverse * shot * inverse).topLeftCorner<2, 2>();
  return by_shot * std::max(1.0, by_residuals.trace() / by_shot.trace());
}

bool plausible(const Vector& q) {
  return q.allFinite() && q[2] > 0.0 && q[4] > 0.0 && q[2] * q[4] > q[3] * q[3] && q[5] > 0.0 &&
         q[5] < 8000.0;
}

}  // namespace

double coverOf(const DiscInPicture& disc, const Eigen::Vector2d& pixel) {
  const double distance_mm = (disc.mm_per_pixel * (pixel - disc.pixel)).norm();
  const double pitch_mm = std::sqrt(std::abs(disc.mm_per_pixel.determinant()));
  return 0.5 * std::erfc((distance_mm - disc.radius_mm) / (std::sqrt(2.0) * kEdgeSigmaPx * pitch_mm));
}

std::optional<SpotFit> fitSpot(const GrayImage& image, const BrightPeak& peak, double board_gray,
                               double noise_gray, std::span<const DiscInPicture> discs) {
  const std::optional<Start> start = growRegion(image, peak, board_gray, noise_gray, discs);
  if (!start) return std::nullopt;
  const Window& w = start->window;
  std::vector<double> cover;
  if (!discs.empty()) {
    cover.reserve(static_cast<std::size_t>(w.width() * w.height()));
    for (int r = w.top; r <= w.bottom; ++r) {
      for (int c = w.left; c <= w.right; ++c) {
        double covered = 0.0;
        for (const DiscInPicture& disc : discs)
          covered = std::max(covered, coverOf(disc, Eigen::Vector2d(c, r)));
        cover.push_back(covered);
      }
    }
  }

  Vector q = start->parameters;
  double damping = 1e-3;
  Sums sums = accumulate(image, w, cover, q);
  for (int round = 0; round < 40; ++round) {
    Matrix a = sums.normal;
    if (cover.empty()) a(7, 7) = 1.0;
    a.diagonal() += damping * a.diagonal();
    a.diagonal().array() += 1e-12;
    const Vector step = a.ldlt().solve(sums.gradient);
    const Vector trial = q + step;
    Sums next;
    const bool allowed = plausible(trial);
    if (allowed) next = accumulate(image, w, cover, trial);
    if (!allowed || next.cost > sums.cost * (1.0 + 1e-12)) {
      damping = std::max(damping, 1e-3) * 10.0;
      if (damping > 1e8) break;
      continue;
    }
    // A short step is the end only if damping has not made it short.
    const bool settled = damping < 1e-3 && std::abs(step[0]) < 1e-4 && std::abs(step[1]) < 1e-4;
    q = trial;
    sums = next;
    damping *= 0.1;
    if (settled) break;
  }
  if (!plausible(q)) return std::nullopt;

  Eigen::Matrix2d inverse_shape;
  inverse_shape << q[2], q[3], q[3], q[4];
  const Eigen::Vector2d inverse_variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(inverse_shape).eigenvalues();
  SpotFit fit;
  fit.pixel = q.head<2>();
  fit.long_sigma_px = 1.0 / std::sqrt(inverse_variances.x());
  fit.short_sigma_px = 1.0 / std::sqrt(inverse_variances.y());
  fit.height_gray = q[5];
  Matrix normal = sums.normal;
  if (cover.empty()) normal(7, 7) = 1.0;
  normal.diagonal().array() += 1e-12;
  const Matrix inverse = normal.ldlt().solve(Matrix::Identity());
  fit.covariance_px2 = centreCovariance(image, w, cover, q, inverse, noise_gray);
  const double height_sigma = noise_gray * std::sqrt(inverse(5, 5));

  // A lens and a pixel blur everything to 0.4 px and more: sharper is a hot pixel. An edge or a patch of
  // light has no end within the window.
  const bool inside =
      fit.pixel.x() > w.left && fit.pixel.x() < w.right && fit.pixel.y() > w.top && fit.pixel.y() < w.bottom;
  if (!inside || fit.short_sigma_px < 0.4 || fit.short_sigma_px > 20.0 ||
      fit.long_sigma_px > 0.75 * kMaxHalfWindow) {
    return std::nullopt;
  }
  if (fit.height_gray < std::max(4.0, 2.5 * noise_gray) ||
      (sums.saturated == 0 && fit.height_gray < 5.0 * height_sigma))
    return std::nullopt;
  if (!fit.covariance_px2.allFinite() || fit.covariance_px2.trace() > 2.0) return std::nullopt;
  return fit;
}

std::optional<BrightPeak> peakOnDisc(const GrayImage& image, const DiscInPicture& disc, double board_gray,
                                     double noise_gray) {
  const double pitch_mm = std::sqrt(std::abs(disc.mm_per_pixel.determinant()));
  const int reach = static_cast<int>(std::ceil(1.2 * disc.radius_mm / pitch_mm)) + 2;
  const int column = static_cast<int>(std::lround(disc.pixel.x()));
  const int row = static_cast<int>(std::lround(disc.pixel.y()));
  const double least = std::max(10.0, 6.0 * noise_gray);
  // A rim that lies a fraction of a pixel off, or is less sharp than thought, leaves a bright line.
  const double least_at_rim = std::max(least, 0.35 * disc.contrast_gray);
  std::optional<BrightPeak> best;
  double best_excess = 0.0;
  for (int r = std::max(0, row - reach); r <= std::min(image.height - 2, row + reach); ++r) {
    for (int c = std::max(0, column - reach); c <= std::min(image.width - 2, column + reach); ++c) {
      const Eigen::Vector2d middle(c + 0.5, r + 0.5);
      const double outside_px =
          ((disc.mm_per_pixel * (middle - disc.pixel)).norm() - disc.radius_mm) / pitch_mm;
      if (outside_px > 3.0) continue;
      const double mean =
          0.25 * (image.gray(c, r) + image.gray(c + 1, r) + image.gray(c, r + 1) + image.gray(c + 1, r + 1));
      const double height = mean + disc.contrast_gray * coverOf(disc, middle) - board_gray;
      const double excess = height - (outside_px > -3.0 ? least_at_rim : least);
      if (excess <= best_excess) continue;
      best_excess = excess;
      best = BrightPeak{c, r, static_cast<int>(height)};
    }
  }
  return best;
}

}  // namespace kerfbench::hil

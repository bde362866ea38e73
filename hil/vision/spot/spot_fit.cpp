// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "hil/vision/spot/spot_model.h"
#include "twin/base/image.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::vision {
namespace {

constexpr int kMaxHalfWindow = 96;
constexpr int kSaturated = 254;
constexpr double kEdgeSigmaPx = 0.7;

// A bell this much longer than wide is fitted as a streak, too. A shorter streak is as good as a bell.
constexpr double kStreakRatio = 1.2;
constexpr double kFaint = 1e-5;  // Share of a spot's height: plain board.

using Vector = SpotParameters::Vector;
using Matrix = SpotParameters::Matrix;

struct Window {
  int left, top, right, bottom;  // Columns and rows, the last ones included.
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

/// The bright region around the peak gives size and direction to start from.
std::optional<Start> growRegion(const GrayImage& image, const BrightPeak& peak, double board, double noise,
                                std::span<const DiscInPicture> discs) {
  const double floor_gray = board + std::max(3.0 * noise, 0.2 * static_cast<double>(peak.height));
  const Window limit{std::max(image.left, peak.column - kMaxHalfWindow),
                     std::max(image.top, peak.row - kMaxHalfWindow),
                     std::min(image.right(), peak.column + kMaxHalfWindow),
                     std::min(image.bottom(), peak.row + kMaxHalfWindow)};
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
  start.window = {std::max(image.left, box.left - margin), std::max(image.top, box.top - margin),
                  std::min(image.right(), box.right + margin), std::min(image.bottom(), box.bottom + margin)};
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

/// A window of the picture, what is printed there, and how much each pixel counts.
class SpotProblem {
 public:
  SpotProblem(const GrayImage& image, const Window& window, const PixelNoise& noise,
              std::span<const DiscInPicture> discs)
      : window_(window), noise_(noise), printed_(!discs.empty()) {
    for (int r = window.top; r <= window.bottom; ++r) {
      for (int c = window.left; c <= window.right; ++c) {
        Pixel& pixel = pixels_.emplace_back();
        pixel.value = image.gray(c, r);
        for (const DiscInPicture& disc : discs)
          pixel.cover = std::max(pixel.cover, coverOf(disc, Eigen::Vector2d(c, r)));
      }
    }
    if (!printed_) leaveOutPrint();
  }

  [[nodiscard]] bool printed() const { return printed_; }
  /// Counts pixels by the noise of the light that the model expects there: by the light that was seen, bright
  /// noise would count less than dark noise.
  void weigh(SpotShape shape, const Vector& q) {
    model(shape, q);
    for (Pixel& pixel : pixels_) pixel.weight = pixel.used ? 1.0 / noise_.variance(pixel.light.value) : 0.0;
  }
  [[nodiscard]] Sums sums(SpotShape shape, const Vector& q);
  [[nodiscard]] std::vector<SpotFit::Influence> influences(SpotShape shape, const Vector& q,
                                                           const Matrix& inverse);
  [[nodiscard]] ShotEvidence shot(SpotShape shape, const Vector& q, const Matrix& inverse);

 private:
  struct Pixel {
    double value{};
    double cover{};
    double weight{1.0};
    bool used{true};
    SpotLight light{};  ///< What the model says for modelled_q_.
    Vector by_q{Vector::Zero()};
  };

  /// Lets the model light the pixels, unless these parameters were the last.
  void model(SpotShape shape, const Vector& q) {
    if (modelled_ && shape == modelled_shape_ && q == modelled_q_) return;
    forEach([&](Pixel& pixel, int c, int r) {
      if (pixel.used) pixel.light = spotLight(shape, q, c, r, pixel.cover, pixel.by_q);
    });
    modelled_ = true;
    modelled_shape_ = shape;
    modelled_q_ = q;
  }

  void leaveOutPrint();

  template <typename Visit>
  void forEach(const Visit& visit) {
    std::size_t i = 0;
    for (int r = window_.top; r <= window_.bottom; ++r) {
      for (int c = window_.left; c <= window_.right; ++c) visit(pixels_[i++], c, r);
    }
  }

  Window window_;
  PixelNoise noise_;
  bool printed_;
  std::vector<Pixel> pixels_;
  bool modelled_{false};
  SpotShape modelled_shape_{};
  Vector modelled_q_{Vector::Zero()};
};

/// Print that is not listed is no part of the model: neither are its blurred edges.
void SpotProblem::leaveOutPrint() {
  constexpr int kEdgePx = 2;
  const double dark =
      noise_.board_gray - std::max(5.0 * std::sqrt(noise_.board_variance), 0.12 * noise_.board_gray);
  std::size_t i = 0;
  for (int r = window_.top; r <= window_.bottom; ++r) {
    for (int c = window_.left; c <= window_.right; ++c, ++i) {
      if (pixels_[i].value >= dark) continue;
      for (int y = std::max(window_.top, r - kEdgePx); y <= std::min(window_.bottom, r + kEdgePx); ++y) {
        for (int x = std::max(window_.left, c - kEdgePx); x <= std::min(window_.right, c + kEdgePx); ++x)
          pixels_[static_cast<std::size_t>((y - window_.top) * window_.width() + x - window_.left)].used =
              false;
      }
    }
  }
}

Sums SpotProblem::sums(SpotShape shape, const Vector& q) {
  model(shape, q);
  Sums sums;
  for (const Pixel& pixel : pixels_) {
    if (!pixel.used) continue;
    const SpotLight& light = pixel.light;
    // Saturated pixel that agrees with the model, and adds nothing.
    if (pixel.value >= kSaturated && light.value >= kSaturated) {
      ++sums.saturated;
      continue;
    }
    const double w = pixel.weight;
    const double residual = pixel.value - std::min(light.value, 255.0);
    sums.cost += w * residual * residual;
    if (light.value > 255.0) continue;
    if (light.bell < kFaint) {  // Plain board or ink: most pixels.
      const double m = pixel.cover;
      sums.normal(6, 6) += w;
      sums.normal(7, 6) += w * m;
      sums.normal(7, 7) += w * m * m;
      sums.gradient[6] += w * residual;
      sums.gradient[7] += w * residual * m;
      continue;
    }
    sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(pixel.by_q, w);
    sums.gradient += w * residual * pixel.by_q;
  }
  sums.normal.triangularView<Eigen::StrictlyUpper>() = sums.normal.transpose();
  if (!printed_) sums.normal(7, 7) = 1.0;
  return sums;
}

ShotEvidence SpotProblem::shot(SpotShape shape, const Vector& q, const Matrix& inverse) {
  model(shape, q);
  ShotEvidence evidence;
  for (const Pixel& pixel : pixels_) {
    if (!pixel.used) continue;
    const SpotLight& light = pixel.light;
    const Vector& j = pixel.by_q;
    const double brighter = light.value - noise_.board_gray;
    if (light.bell < 0.02 || brighter <= 0.0 || light.value > 0.9 * kSaturated) continue;
    // The fit takes its share of the pixel's noise along with it.
    const double left = 1.0 - pixel.weight * j.dot(inverse * j);
    if (left < 0.3) continue;
    const double residual = pixel.value - light.value;
    const double w2 = pixel.weight * pixel.weight * left * left;
    evidence.products += w2 * brighter * (residual * residual / left - noise_.board_variance);
    evidence.squares += w2 * brighter * brighter;
  }
  return evidence;
}

std::vector<SpotFit::Influence> SpotProblem::influences(SpotShape shape, const Vector& q,
                                                        const Matrix& inverse) {
  model(shape, q);
  std::vector<SpotFit::Influence> all;
  forEach([&](const Pixel& pixel, int c, int r) {
    if (!pixel.used) return;
    const SpotLight& light = pixel.light;
    if (light.bell < 1e-3 || light.value > 255.0) return;
    all.push_back(
        {c, r, pixel.weight * (inverse.topRows<2>() * pixel.by_q), light.value - noise_.board_gray});
  });
  return all;
}

struct Solution {
  SpotShape shape;
  Vector q;
  Sums sums;
};

/// Levenberg and Marquardt, in rounds of fixed weights.
Solution solve(SpotProblem& problem, SpotShape shape, const Vector& start) {
  Solution best{shape, start, {}};
  for (int round = 0; round < 3; ++round) {
    problem.weigh(shape, best.q);
    best.sums = problem.sums(shape, best.q);
    double damping = round == 0 ? 1e-3 : 1e-6;
    for (int step_count = 0; step_count < 40; ++step_count) {
      Matrix a = best.sums.normal;
      a.diagonal() += damping * a.diagonal();
      a.diagonal().array() += 1e-12;
      const Vector step = a.ldlt().solve(best.sums.gradient);
      const Vector trial = best.q + step;
      Sums next;
      const bool allowed = plausible(shape, trial);
      if (allowed) next = problem.sums(shape, trial);
      if (!allowed || next.cost > best.sums.cost * (1.0 + 1e-12)) {
        damping = std::max(damping, 1e-3) * 10.0;
        if (damping > 1e8) break;
        continue;
      }
      // A short step is the end only if damping has not made it short.
      const double enough = round == 0 ? 0.02 : 1e-4;
      const bool settled = damping < 1e-2 && std::abs(step[0]) < enough && std::abs(step[1]) < enough;
      best.q = trial;
      best.sums = next;
      damping *= 0.1;
      if (settled) break;
    }
  }
  return best;
}

}  // namespace

double coverOf(const DiscInPicture& disc, const Eigen::Vector2d& pixel) {
  const double distance_mm = (disc.mm_per_pixel * (pixel - disc.pixel)).norm();
  const double pitch_mm = std::sqrt(std::abs(disc.mm_per_pixel.determinant()));
  return 0.5 * std::erfc((distance_mm - disc.radius_mm) / (std::sqrt(2.0) * kEdgeSigmaPx * pitch_mm));
}

std::optional<SpotFit> fitSpot(const GrayImage& image, const BrightPeak& peak, double board_gray,
                               const PixelNoise& noise, std::span<const DiscInPicture> discs) {
  const double noise_gray = std::sqrt(noise.board_variance);
  const std::optional<Start> start = growRegion(image, peak, board_gray, noise_gray, discs);
  if (!start) return std::nullopt;
  const Window& w = start->window;
  SpotProblem problem(image, w, noise, discs);
  Solution found = solve(problem, SpotShape::kBell, start->parameters);
  if (!plausible(found.shape, found.q)) return std::nullopt;
  Eigen::Vector2d variances = SymmetricEigen<2>(momentsOf(found.shape, found.q)).values;
  if (variances.y() > kStreakRatio * kStreakRatio * variances.x()) {
    Solution streak = solve(problem, SpotShape::kStreak, streakLike(found.q));
    if (plausible(streak.shape, streak.q) && streak.sums.cost < found.sums.cost) found = streak;
    variances = SymmetricEigen<2>(momentsOf(found.shape, found.q)).values;
  }

  SpotFit fit;
  fit.pixel = found.q.head<2>();
  fit.long_sigma_px = std::sqrt(variances.y());
  fit.short_sigma_px = std::sqrt(variances.x());
  fit.height_gray = found.q[5] * spotLight(found.shape, found.q, fit.pixel.x(), fit.pixel.y(), 0.0).bell;
  Matrix normal = found.sums.normal;
  normal.diagonal().array() += 1e-12;
  const Matrix inverse = normal.ldlt().solve(Matrix::Identity());
  fit.covariance_px2 = inverse.topLeftCorner<2, 2>();
  fit.influences = problem.influences(found.shape, found.q, inverse);
  fit.shot = problem.shot(found.shape, found.q, inverse);
  const double height_sigma = std::sqrt(inverse(5, 5)) * fit.height_gray / found.q[5];

  // A lens and a pixel blur everything to 0.4 px and more: sharper is a hot pixel. An edge or a patch of
  // light has no end within the window.
  const bool inside =
      fit.pixel.x() > w.left && fit.pixel.x() < w.right && fit.pixel.y() > w.top && fit.pixel.y() < w.bottom;
  if (!inside || fit.short_sigma_px < 0.4 || fit.short_sigma_px > 20.0 ||
      fit.long_sigma_px > 0.75 * kMaxHalfWindow) {
    return std::nullopt;
  }
  if (fit.height_gray < std::max(4.0, 2.5 * noise_gray) ||
      (found.sums.saturated == 0 && fit.height_gray < 5.0 * height_sigma))
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
  for (int r = std::max(image.top, row - reach); r <= std::min(image.bottom() - 1, row + reach); ++r) {
    for (int c = std::max(image.left, column - reach); c <= std::min(image.right() - 1, column + reach);
         ++c) {
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

}  // namespace kerfbench::vision

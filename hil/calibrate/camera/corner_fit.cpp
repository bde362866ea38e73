// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/corner_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
constexpr int kParameters = 9;
using Vector9 = Eigen::Matrix<double, kParameters, 1>;
using Matrix9 = Eigen::Matrix<double, kParameters, kParameters>;

constexpr int kCornerRounds = 40;
constexpr double kSettled_px = 1e-7;
constexpr double kFar = 5.0;      // Sigmas from an edge beyond which the other one is all that counts.
constexpr double kOutlier = 6.0;  // In units of the window's noise.
constexpr double kMaxBlur_px = 6.0;

double normalDensity(double u) { return std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi); }
/// Mean sign of a standard normal variable around u.
double meanSign(double u) { return std::erf(u / std::numbers::sqrt2); }

/// Mean of sign(U + u) sign(V + v) for standard normal U, V of this correlation, with its derivatives.
struct SignProduct {
  double value, by_u, by_v, by_correlation;
};

SignProduct signProduct(double u, double v, double correlation) {
  SignProduct out{meanSign(u) * meanSign(v), 0.0, 0.0, 0.0};
  const double root = std::sqrt(1.0 - correlation * correlation);
  out.by_u = 2.0 * normalDensity(u) * meanSign((v - correlation * u) / root);
  out.by_v = 2.0 * normalDensity(v) * meanSign((u - correlation * v) / root);
  if (std::abs(u) > kFar || std::abs(v) > kFar) return out;
  // 4 / (2 pi) times the integral of exp(-(u² + v² - 2 u v sin t) / (2 cos² t)) over t in [0, asin(r)].
  constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                        0.9602898564975363};
  constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                          0.1012285362903763};
  const double half = 0.5 * std::asin(correlation);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    for (const double node : {-kNode[i], kNode[i]}) {
      const double sine = std::sin(half * (1.0 + node));
      sum += kWeight[i] * std::exp(-(u * u + v * v - 2.0 * u * v * sine) / (2.0 * (1.0 - sine * sine)));
    }
  }
  out.value += 2.0 * half * sum / std::numbers::pi;
  out.by_correlation = 2.0 / (std::numbers::pi * root) *
                       std::exp(-(u * u + v * v - 2.0 * correlation * u * v) / (2.0 * root * root));
  return out;
}

struct Sample {
  double x, y;  // From the window's middle.
  double gray;
  bool used;
};

/// Order: place (2), directions of the two edges' normals (2), blur, mean grey, half the contrast, slope of
/// the light (2).
struct Corner {
  Vector9 p;

  /// Grey at a sample, and its derivatives.
  double gray(const Sample& s, Vector9& by) const {
    const Vector2d d(s.x - p[0], s.y - p[1]);
    const Vector2d n1(std::cos(p[2]), std::sin(p[2]));
    const Vector2d n2(std::cos(p[3]), std::sin(p[3]));
    const double u = n1.dot(d) / p[4];
    const double v = n2.dot(d) / p[4];
    const SignProduct pattern = signProduct(u, v, n1.dot(n2));
    const double light = 1.0 + p[7] * s.x + p[8] * s.y;
    const double scale = light * p[6];
    by.head<2>() = -scale / p[4] * (pattern.by_u * n1 + pattern.by_v * n2);
    const double turn = std::sin(p[2] - p[3]);
    by[2] = scale * (pattern.by_u * (n1.x() * d.y() - n1.y() * d.x()) / p[4] - pattern.by_correlation * turn);
    by[3] = scale * (pattern.by_v * (n2.x() * d.y() - n2.y() * d.x()) / p[4] + pattern.by_correlation * turn);
    by[4] = -scale / p[4] * (pattern.by_u * u + pattern.by_v * v);
    const double dark = p[5] + p[6] * pattern.value;
    by[5] = light;
    by[6] = light * pattern.value;
    by[7] = dark * s.x;
    by[8] = dark * s.y;
    return light * dark;
  }

  [[nodiscard]] bool sane(double radius_px) const {
    return p.allFinite() && p.head<2>().norm() < 0.6 * radius_px && p[4] > 0.05 && p[4] < kMaxBlur_px &&
           std::abs(std::sin(p[2] - p[3])) > 0.2 && p[5] - std::abs(p[6]) > -64.0;
  }
};

Matrix9 normalOf(const Corner& corner, const std::vector<Sample>& samples, Vector9& right) {
  Matrix9 normal = Matrix9::Zero();
  right.setZero();
  for (const Sample& s : samples) {
    if (!s.used) continue;
    Vector9 by;
    const double miss = s.gray - corner.gray(s, by);
    normal.noalias() += by * by.transpose();
    right += miss * by;
  }
  return normal;
}

double squares(const Corner& corner, const std::vector<Sample>& samples) {
  double sum = 0.0;
  Vector9 unused;
  for (const Sample& s : samples) {
    if (!s.used) continue;
    const double miss = s.gray - corner.gray(s, unused);
    sum += miss * miss;
  }
  return sum;
}

/// Levenberg and Marquardt. False where it does not settle.
bool settle(Corner& corner, const std::vector<Sample>& samples, double radius_px) {
  double damping = 1e-3;
  double sum = squares(corner, samples);
  for (int round = 0; round < kCornerRounds; ++round) {
    Vector9 right;
    const Matrix9 normal = normalOf(corner, samples, right);
    bool better = false;
    for (int attempt = 0; attempt < 8 && !better; ++attempt) {
      Matrix9 damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const Vector9 step = damped.ldlt().solve(right);
      Corner next = corner;
      next.p += step;
      const double next_sum = next.sane(radius_px) ? squares(next, samples) : HUGE_VAL;
      if (next_sum <= sum) {
        better = true;
        corner = next;
        sum = next_sum;
        damping = std::max(1e-9, 0.1 * damping);
        if (step.head<2>().norm() < kSettled_px) return true;
      } else {
        if (step.head<2>().norm() < kSettled_px) return true;  // Rounding alone is left.
        damping *= 10.0;
      }
    }
    if (!better) return false;
  }
  return false;
}

/// The pixels of a disc around a guess, and what is light and dark among them.
struct CornerPixels {
  int cx, cy;  // Middle of the disc.
  std::vector<Sample> samples;
  double mean{0.0};
  double least{1e9};
  double most{-1e9};
};

std::optional<CornerPixels> pixelsAround(const GrayImage& image, const CornerGuess& guess) {
  CornerPixels pixels{
      static_cast<int>(std::lround(guess.pixel.x())), static_cast<int>(std::lround(guess.pixel.y())), {}};
  const int r = guess.radius_px;
  const int cx = pixels.cx;
  const int cy = pixels.cy;
  if (r < 3 || cx < r || cy < r || cx + r >= image.width || cy + r >= image.height) return std::nullopt;
  pixels.samples.reserve(static_cast<std::size_t>((2 * r + 1) * (2 * r + 1)));
  for (int y = -r; y <= r; ++y) {
    for (int x = -r; x <= r; ++x) {
      // A disc: what lies in the window's corners says nothing of the edges' place.
      if (x * x + y * y > (r + 0.5) * (r + 0.5)) continue;
      const double gray = image.gray(cx + x, cy + y);
      pixels.samples.push_back({static_cast<double>(x), static_cast<double>(y), gray, true});
      pixels.mean += gray;
      pixels.least = std::min(pixels.least, gray);
      pixels.most = std::max(pixels.most, gray);
    }
  }
  pixels.mean /= static_cast<double>(pixels.samples.size());
  if (!(pixels.most - pixels.least > 10.0)) return std::nullopt;
  return pixels;
}

Corner firstCorner(const CornerPixels& pixels, const CornerGuess& guess) {
  Corner corner;
  // The edge along the target's x has its normal across it.
  const double a1 = std::atan2(guess.along_y.x(), -guess.along_y.y());
  const double a2 = std::atan2(guess.along_x.x(), -guess.along_x.y());
  corner.p << guess.pixel.x() - pixels.cx, guess.pixel.y() - pixels.cy, a1, a2, 1.0, pixels.mean, 0.0, 0.0,
      0.0;
  double sign = 0.0;
  for (const Sample& s : pixels.samples) {
    const Vector2d d(s.x - corner.p[0], s.y - corner.p[1]);
    sign += (s.gray - pixels.mean) * std::copysign(1.0, Vector2d(std::cos(a1), std::sin(a1)).dot(d)) *
            std::copysign(1.0, Vector2d(std::cos(a2), std::sin(a2)).dot(d));
  }
  corner.p[6] = std::copysign(0.4 * (pixels.most - pixels.least), sign);
  return corner;
}

/// Leaves out hot pixels. @returns whether there were any.
bool dropOutliers(const Corner& corner, std::vector<Sample>& samples) {
  // Median against hot pixels: they would carry the RMS, and themselves, past any limit.
  std::vector<double> misses;
  Vector9 unused;
  for (const Sample& s : samples) misses.push_back(std::abs(s.gray - corner.gray(s, unused)));
  const double limit = kOutlier * std::max(kMadToSigma * upperMedianOf(misses), 0.3);
  bool dropped = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (misses[i] <= limit) continue;
    samples[i].used = false;
    dropped = true;
  }
  return dropped;
}

double noiseOf(const Corner& corner, const std::vector<Sample>& samples) {
  const auto used = std::ranges::count_if(samples, &Sample::used);
  return std::sqrt(squares(corner, samples) / static_cast<double>(std::max<long>(1, used - kParameters)));
}

}  // namespace

std::optional<TargetCornerFit> fitCorner(const GrayImage& image, const CornerGuess& guess) {
  const int r = guess.radius_px;
  std::optional<CornerPixels> pixels = pixelsAround(image, guess);
  if (!pixels) return std::nullopt;
  std::vector<Sample>& samples = pixels->samples;
  Corner corner = firstCorner(*pixels, guess);
  if (!settle(corner, samples, r)) return std::nullopt;
  double noise = noiseOf(corner, samples);
  if (dropOutliers(corner, samples)) {
    const auto left = static_cast<std::size_t>(std::ranges::count_if(samples, &Sample::used));
    if (10 * left < 9 * samples.size() || !settle(corner, samples, r)) return std::nullopt;
    noise = noiseOf(corner, samples);
  }
  TargetCornerFit fit;
  fit.pixel = corner.p.head<2>() + Vector2d(pixels->cx, pixels->cy);
  fit.blur_px = corner.p[4];
  fit.contrast = 2.0 * std::abs(corner.p[6]);
  fit.noise = noise;
  Vector9 unused;
  const Matrix9 normal = normalOf(corner, samples, unused);
  const Eigen::Matrix<double, kParameters, 2> place = Eigen::Matrix<double, kParameters, 2>::Identity();
  fit.covariance_px2 = noise * noise * normal.ldlt().solve(place).topRows<2>();
  if (!(fit.contrast > 10.0 && fit.contrast > 6.0 * noise && fit.covariance_px2.allFinite() &&
        fit.covariance_px2.determinant() > 0.0))
    return std::nullopt;
  return fit;
}

}  // namespace kerfbench::calibrate

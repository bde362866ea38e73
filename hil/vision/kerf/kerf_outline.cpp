// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hil/vision/kerf/kerf_sampling.h"

namespace kerfbench::vision {
namespace {

constexpr int kStripLines = 11;
constexpr double kStripEndsPx2 = 1.0 / 12.0;  // Variance by pixels that count in part at a strip's ends.
constexpr double kStepsPerPx = 4.0;
constexpr double kReachMm = 0.45;  // Reach of a look, each way.
constexpr int kOutlineTopSamples = 40;
constexpr double kMostShare = 50.0;

}  // namespace

KerfOutline::KerfOutline(const KerfLook& look)
    : look_(look),
      law_(std::clamp(look.board_gray / look.open_gray, 0.5 / look.open_gray, 0.9), look.growth),
      step_mm_(look.pixel_mm / kStepsPerPx) {
  look_.board_gray = std::clamp(look.board_gray, 0.5, 0.9 * look.open_gray);
  const int samples = samplesOfLook();
  const auto seenHalf = [&](double peak) {
    std::vector<double> gray;
    for (int i = 0; i < samples; ++i) {
      const double a = (-kReachMm + i * step_mm_) / look_.beam_radius_mm;
      gray.push_back(grayAt(peak * std::exp(-2.0 * a * a)));
    }
    return fallMm(gray, -kReachMm);
  };
  const double top = look_.board_gray + look_.brightness * (look_.open_gray - look_.board_gray);
  const double seen_peak = law_.shareAt(std::min(1.0, top / look_.open_gray));
  if (!(look_.beam_radius_mm > 0.0)) {
    peak_share_ = look_.brightness > 0.9 ? 1.0 : seen_peak;
    return;
  }
  // The wider, the more energy; a kerf that is not open shows it by its light, which the lens has dimmed.
  const bool open = look_.brightness > 0.85;
  double low = std::max(1e-3, std::min(1.0, seen_peak));
  double high = kMostShare;
  for (int i = 0; i < 30 && high / low > 1.001; ++i) {
    const double middle = std::sqrt(low * high);
    const bool less = open ? seenHalf(middle) < look_.half_width_mm : seenTop(middle) < top;
    (less ? low : high) = middle;
  }
  peak_share_ = std::sqrt(low * high);
}

int KerfOutline::samplesOfLook() const { return 1 + static_cast<int>(2.0 * kReachMm / step_mm_); }

double KerfOutline::seenTop(double peak) const {
  const double sigma_mm = std::hypot(look_.lens_px, kPeakPx / std::numbers::sqrt3) * look_.pixel_mm;
  double sum = 0.0;
  double weight = 0.0;
  for (int i = -kOutlineTopSamples; i <= kOutlineTopSamples; ++i) {
    const double y = 3.5 * sigma_mm * i / kOutlineTopSamples;
    const double a = y / look_.beam_radius_mm;
    const double w = std::exp(-0.5 * y * y / (sigma_mm * sigma_mm));
    sum += w * grayAt(peak * std::exp(-2.0 * a * a));
    weight += w;
  }
  return sum / weight;
}

double KerfOutline::grayAt(double share) const { return look_.open_gray * law_.lightAt(share); }

double KerfOutline::fallMm(const std::vector<double>& gray, double first_mm) const {
  const double sigma = std::hypot(look_.lens_px, kSplinePx) * kStepsPerPx;
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  const double level = look_.board_gray + 0.5 * look_.brightness * (look_.open_gray - look_.board_gray);
  const int n = static_cast<int>(gray.size());
  std::vector<double> kernel;
  double weight = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    kernel.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    weight += kernel.back();
  }
  const auto blurredAt = [&](int i) {
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k)
      sum += kernel[static_cast<std::size_t>(k + reach)] *
             gray[static_cast<std::size_t>(std::clamp(i + k, 0, n - 1))];
    return sum / weight;
  };
  // From outside inwards.
  double outer = blurredAt(n - 1);
  for (int i = n - 2; i >= 0; --i) {
    const double inner = blurredAt(i);
    if (inner >= level) {
      return first_mm + step_mm_ * (static_cast<double>(i) + (inner - level) / std::max(1e-9, inner - outer));
    }
    outer = inner;
  }
  return first_mm;
}

double KerfOutline::shareAt(double beyond_mm, double beside_mm) const {
  const double w = look_.beam_radius_mm;
  if (!(w > 0.0)) {
    const double distance = beyond_mm > 0.0 ? std::hypot(beyond_mm, beside_mm) : std::abs(beside_mm);
    return distance < look_.half_width_mm ? peak_share_ : 0.0;
  }
  const double n = beside_mm / w;
  return peak_share_ * std::exp(-2.0 * n * n) * 0.5 * std::erfc(std::numbers::sqrt2 * beyond_mm / w);
}

double KerfOutline::reachMm(double strip_mm) const {
  // Across the strip the lens averages too, and pixels count in part at its ends.
  const double lens_mm = look_.lens_px * look_.pixel_mm;
  const double even_mm =
      std::sqrt(strip_mm * strip_mm + 3.0 * kStripEndsPx2 * look_.pixel_mm * look_.pixel_mm);
  std::vector<std::array<double, 2>> lines;  // Place and weight.
  double weights = 0.0;
  for (int i = 0; i < kStripLines; ++i) {
    const double y = (even_mm + 2.5 * lens_mm) * (2.0 * (i + 0.5) / kStripLines - 1.0);
    const double to = std::numbers::sqrt2 * lens_mm;
    lines.push_back({y, std::erf((y + even_mm) / to) - std::erf((y - even_mm) / to)});
    weights += lines.back()[1];
  }
  std::vector<double> gray;
  for (int k = 0; k < samplesOfLook(); ++k) {
    const double x = -kReachMm + k * step_mm_;
    double sum = 0.0;
    for (const auto& [y, weight] : lines) sum += weight * grayAt(shareAt(x, y));
    gray.push_back(sum / weights);
  }
  return fallMm(gray, -kReachMm);
}

}  // namespace kerfbench::vision

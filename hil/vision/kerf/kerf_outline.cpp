// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_outline.h"

#include <algorithm>
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

double sigmaStepsOf(const KerfLook& look) { return std::hypot(look.lens_px, kSplinePx) * kStepsPerPx; }

}  // namespace

KerfOutline::KerfOutline(const KerfLook& look)
    : look_(look),
      law_(std::clamp(look.board_gray / look.open_gray, 0.5 / look.open_gray, 0.9), look.growth),
      step_mm_(look.pixel_mm / kStepsPerPx),
      kernel_(sigmaStepsOf(look), static_cast<int>(std::ceil(3.5 * sigmaStepsOf(look)))) {
  look_.board_gray = std::clamp(look.board_gray, 0.5, 0.9 * look.open_gray);
  peak_share_ = fittedPeak();
}

double KerfOutline::fittedPeak() const {
  const double top = look_.board_gray + look_.brightness * (look_.open_gray - look_.board_gray);
  const double seen_peak = law_.shareAt(std::min(1.0, top / look_.open_gray));
  if (!(look_.beam_radius_mm > 0.0)) return look_.brightness > 0.9 ? 1.0 : seen_peak;
  std::vector<double> beam;
  for (int i = 0; i < samplesOfLook(); ++i) {
    const double a = (-kReachMm + i * step_mm_) / look_.beam_radius_mm;
    beam.push_back(std::exp(-2.0 * a * a));
  }
  std::vector<double> gray(beam.size());
  const auto seenHalf = [&](double peak) {
    for (std::size_t i = 0; i < beam.size(); ++i) gray[i] = grayAt(peak * beam[i]);
    return fallMm(gray, -kReachMm);
  };
  const Middle seen(look_);
  // The wider, the more energy; a kerf that is not open shows it by its light, which the lens has dimmed.
  const bool open = look_.brightness > 0.85;
  double low = std::max(1e-3, std::min(1.0, seen_peak));
  double high = kMostShare;
  for (int i = 0; i < 30 && high / low > 1.001; ++i) {
    const double middle = std::sqrt(low * high);
    const bool less = open ? seenHalf(middle) < look_.half_width_mm : seen.grayAt(middle, *this) < top;
    (less ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

int KerfOutline::samplesOfLook() const { return 1 + static_cast<int>(2.0 * kReachMm / step_mm_); }

KerfOutline::Middle::Middle(const KerfLook& look) {
  const double sigma_mm = std::hypot(look.lens_px, kPeakPx / std::numbers::sqrt3) * look.pixel_mm;
  for (int i = -kOutlineTopSamples; i <= kOutlineTopSamples; ++i) {
    const double y = 3.5 * sigma_mm * i / kOutlineTopSamples;
    const double a = y / look.beam_radius_mm;
    weights_.push_back(std::exp(-0.5 * y * y / (sigma_mm * sigma_mm)));
    beam_.push_back(std::exp(-2.0 * a * a));
    weight_ += weights_.back();
  }
}

double KerfOutline::Middle::grayAt(double peak, const KerfOutline& outline) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < beam_.size(); ++i) sum += weights_[i] * outline.grayAt(peak * beam_[i]);
  return sum / weight_;
}

double KerfOutline::grayAt(double share) const { return look_.open_gray * law_.lightAt(share); }

double KerfOutline::fallMm(const std::vector<double>& gray, double first_mm) const {
  const double level = look_.board_gray + 0.5 * look_.brightness * (look_.open_gray - look_.board_gray);
  const int n = static_cast<int>(gray.size());
  BlurredProfile seen(gray.size(), kernel_,
                      [&](int i) { return gray[static_cast<std::size_t>(std::clamp(i, 0, n - 1))]; });
  // From outside inwards.
  double outer = seen[gray.size() - 1];
  for (std::size_t i = gray.size() - 1; i-- > 0;) {
    const double inner = seen[i];
    if (inner >= level) {
      return first_mm + step_mm_ * (static_cast<double>(i) + (inner - level) / std::max(1e-9, inner - outer));
    }
    outer = inner;
  }
  return first_mm;
}

double KerfOutline::reachMm(double strip_mm) const {
  // Across the strip the lens averages too, and pixels count in part at its ends.
  const double lens_mm = look_.lens_px * look_.pixel_mm;
  const double even_mm =
      std::sqrt(strip_mm * strip_mm + 3.0 * kStripEndsPx2 * look_.pixel_mm * look_.pixel_mm);
  const double w = look_.beam_radius_mm;
  struct Line {
    double beside_mm, weight;
    double half_share;  ///< Half of the share of a path without end.
  };
  std::vector<Line> lines;
  double weights = 0.0;
  for (int i = 0; i < kStripLines; ++i) {
    const double y = (even_mm + 2.5 * lens_mm) * (2.0 * (i + 0.5) / kStripLines - 1.0);
    const double to = std::numbers::sqrt2 * lens_mm;
    const double n = y / w;
    lines.push_back({y, std::erf((y + even_mm) / to) - std::erf((y - even_mm) / to),
                     peak_share_ * std::exp(-2.0 * n * n) * 0.5});
    weights += lines.back().weight;
  }
  const auto meanOver = [&](const auto& shareOf) {
    double sum = 0.0;
    for (const Line& line : lines) sum += line.weight * grayAt(shareOf(line));
    return sum / weights;
  };
  std::vector<double> gray;
  for (int k = 0; k < samplesOfLook(); ++k) {
    const double beyond_mm = -kReachMm + k * step_mm_;
    if (w > 0.0) {
      const double ended = std::erfc(std::numbers::sqrt2 * beyond_mm / w);
      gray.push_back(meanOver([&](const Line& line) { return line.half_share * ended; }));
      continue;
    }
    gray.push_back(meanOver([&](const Line& line) {
      const double distance_mm =
          beyond_mm > 0.0 ? std::hypot(beyond_mm, line.beside_mm) : std::abs(line.beside_mm);
      return distance_mm < look_.half_width_mm ? peak_share_ : 0.0;
    }));
  }
  return fallMm(gray, -kReachMm);
}

}  // namespace kerfbench::vision

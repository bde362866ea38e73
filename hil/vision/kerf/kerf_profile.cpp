// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/LU>

#include "twin/base/image.h"
#include "twin/base/multiversion.h"

namespace kerfbench::vision {
namespace {

/// Least rest of the radius: beyond the centre of a hole its far side begins.
constexpr double kLeastRest = 0.1;
constexpr double kStraight_per_mm = 1e-6;

constexpr std::size_t kStepsPerPixel = 3;
constexpr std::size_t kTaps = 6 * kStepsPerPixel;  // Taps of the quintic B-spline, which is six pixels wide.
constexpr float kFoot = 0.5F * static_cast<float>(kTaps);
constexpr std::size_t kPhases = 64;  // Phases of a sample's step.

constexpr std::size_t kPadded = (kTaps + 7) / 8 * 8;  // Taps filled up to whole vectors of the processor.

using Taps = std::array<float, kPadded>;

double quinticSpline(double t) {
  const double a = std::abs(t);
  const auto power = [](double x) { return x > 0.0 ? x * x * x * x * x : 0.0; };
  return (power(3.0 - a) - 6.0 * power(2.0 - a) + 15.0 * power(1.0 - a)) / 120.0;
}

/// Weights of the samples around a place that lies phase/kPhases of a step above sample kTaps/2 - 1.
const std::array<Taps, kPhases>& tapTable() {
  static const auto table = [] {
    std::array<Taps, kPhases> t{};
    for (std::size_t phase = 0; phase < kPhases; ++phase) {
      const double at = (static_cast<double>(phase) + 0.5) / kPhases + kTaps / 2.0 - 1.0;
      for (std::size_t i = 0; i < kTaps; ++i) {
        t[phase][i] = static_cast<float>(quinticSpline((static_cast<double>(i) - at) / kStepsPerPixel));
      }
    }
    return t;
  }();
  return table;
}

/// Columns of one row of pixels that lie inside |offset + slope * column - middle| <= half.
void clip(double at_zero, double slope, double low, double high, double& first, double& last) {
  if (std::abs(slope) < 1e-12) {
    if (at_zero < low || at_zero > high) last = first - 1.0;
    return;
  }
  const double a = (low - at_zero) / slope;
  const double b = (high - at_zero) / slope;
  first = std::max(first, std::min(a, b));
  last = std::min(last, std::max(a, b));
}

/// A caliper's window in a picture, a pixel's half wider than it is.
struct WindowInPicture {
  WindowInPicture(const CaliperWindow& window, const Eigen::Vector2d& at, const Eigen::Matrix2d& from_pixel)
      : pixel(at),
        window_from_pixel(from_pixel),
        pixel_mm(from_pixel.row(0).norm()),
        back_mm(window.back_mm + 0.5 * pixel_mm),
        ahead_mm(window.ahead_mm + 0.5 * pixel_mm),
        bend_per_mm(window.curvature_per_mm) {
    // A curve leaves its tangent: read that much farther out.
    const double along_mm = std::max(window.back_mm, window.ahead_mm);
    reach_mm = window.reach_mm + 0.5 * std::abs(bend_per_mm) * along_mm * along_mm;
  }

  /// The first and the last row of a picture that it touches.
  [[nodiscard]] std::pair<int, int> rows(const GrayImage& image) const {
    const Eigen::Matrix2d pixel_from_window = window_from_pixel.inverse();
    Eigen::AlignedBox2d box;
    for (const double a : {-back_mm, ahead_mm}) {
      for (const double n : {-reach_mm, reach_mm}) {
        box.extend(pixel + pixel_from_window * Eigen::Vector2d(a, n));
      }
    }
    return {std::max(0, static_cast<int>(std::ceil(box.min().y()))),
            std::min(image.height - 1, static_cast<int>(std::floor(box.max().y())))};
  }

  Eigen::Vector2d pixel;              // What the window's origin is in the picture.
  Eigen::Matrix2d window_from_pixel;  // mm along and across for each pixel.
  double pixel_mm;
  double back_mm, ahead_mm;
  double bend_per_mm;
  double reach_mm{};
};

/// Part of a row of pixels, in a window along a straight line.
struct StraightRow {
  int begin{}, end{};          // First and last column.
  double along_mm, across_mm;  // Place of column 0.
  double along_step_mm, across_step_mm;
  double back_mm, ahead_mm;  // Reach of the window along the line.
  double per_pixel;          // Pixels per mm.
};

template <typename Level>
inline void fillRow(const StraightRow& at, const Level* levels, float factor, PixelAcross* out) {
  for (int c = at.begin; c <= at.end; ++c) {
    const double a = at.along_mm + at.along_step_mm * c;
    const double n = at.across_mm + at.across_step_mm * c;
    const double share =
        std::min(std::min(1.0, (a + at.back_mm) * at.per_pixel), (at.ahead_mm - a) * at.per_pixel);
    out[c - at.begin] = {static_cast<float>(n), static_cast<float>(a), factor * static_cast<float>(levels[c]),
                         static_cast<float>(share)};
  }
}
KERFBENCH_WIDE void fillStraight(const StraightRow& at, const std::uint8_t* levels, float factor,
                                 PixelAcross* out) {
  fillRow(at, levels, factor, out);
}
KERFBENCH_WIDE void fillStraight(const StraightRow& at, const std::uint16_t* levels, float factor,
                                 PixelAcross* out) {
  fillRow(at, levels, factor, out);
}

template <typename Level>
void collect(const Level* levels, double scale, const GrayImage& image, const WindowInPicture& window,
             std::vector<PixelAcross>& out) {
  const double bend = window.bend_per_mm;
  const bool straight = std::abs(bend) < kStraight_per_mm;
  // A pixel at the end of the window counts by its share inside: rows of pixels must not come and go at once.
  const double per_pixel = 1.0 / window.pixel_mm;
  const double back_mm = window.back_mm;
  const double ahead_mm = window.ahead_mm;
  const Eigen::Matrix2d& window_from_pixel = window.window_from_pixel;
  const auto factor = static_cast<float>(scale);
  const auto [top, bottom] = window.rows(image);
  for (int r = top; r <= bottom; ++r) {
    const Eigen::Vector2d at_zero = window_from_pixel * (Eigen::Vector2d(0.0, r) - window.pixel);
    double first = 0.0;
    double last = image.width - 1.0;
    clip(at_zero.x(), window_from_pixel(0, 0), -back_mm, ahead_mm, first, last);
    clip(at_zero.y(), window_from_pixel(1, 0), -window.reach_mm, window.reach_mm, first, last);
    const int begin = static_cast<int>(std::ceil(first));
    const int end = static_cast<int>(std::floor(last));
    const Level* row = levels + static_cast<std::size_t>(r) * static_cast<std::size_t>(image.width);
    if (straight) {
      if (end < begin) continue;
      const std::size_t first_out = out.size();
      out.resize(first_out + static_cast<std::size_t>(end - begin + 1));
      fillStraight({begin, end, at_zero.x(), at_zero.y(), window_from_pixel(0, 0), window_from_pixel(1, 0),
                    back_mm, ahead_mm, per_pixel},
                   row, factor, out.data() + first_out);
      // Shares fall towards the ends of the window, and are nothing there alone.
      while (out.size() > first_out && !(out.back().share > 0.0F)) out.pop_back();
      while (out.size() > first_out && !(out[first_out].share > 0.0F))
        out.erase(out.begin() + static_cast<std::ptrdiff_t>(first_out));
      continue;
    }
    for (int c = begin; c <= end; ++c) {
      const double a = at_zero.x() + window_from_pixel(0, 0) * c;
      double n = at_zero.y() + window_from_pixel(1, 0) * c;
      // Distance from the osculating circle, written so that nothing cancels.
      const double rest = 1.0 - bend * n;
      if (rest < kLeastRest) continue;
      n = (n * (2.0 - bend * n) - bend * a * a) / (1.0 + std::sqrt(rest * rest + bend * bend * a * a));
      const double share = std::min({1.0, (a + back_mm) * per_pixel, (ahead_mm - a) * per_pixel});
      if (!(share > 0.0)) continue;
      out.push_back({static_cast<float>(n), static_cast<float>(a), factor * static_cast<float>(row[c]),
                     static_cast<float>(share)});
    }
  }
}

/// Adds each pixel to the samples around it; sample i of the profile is [i + kTaps] of `gray` and `weight`.
KERFBENCH_WIDE void addPixels(std::span<const PixelAcross> pixels, float per_step, float zero, float limit,
                              float* __restrict gray, float* __restrict weight) {
  const Taps* const table = tapTable().data();
  for (const PixelAcross& pixel : pixels) {
    const float place = pixel.across_mm * per_step + zero;
    if (!(place >= kFoot) || place >= limit) continue;
    const int whole = static_cast<int>(place);
    const auto phase = static_cast<std::size_t>((place - static_cast<float>(whole)) * kPhases);
    const float* __restrict taps = table[std::min(phase, kPhases - 1)].data();
    const std::size_t from = static_cast<std::size_t>(whole) + 1 - kTaps / 2;
    const float light = pixel.share * pixel.gray;
    const float share = pixel.share;
    for (std::size_t i = 0; i < kPadded; ++i) {
      gray[from + i] += taps[i] * light;
      weight[from + i] += taps[i] * share;
    }
  }
}

void spread(Profile& profile, std::size_t count) {
  // Room for the spline's feet at both ends.
  profile.gray.assign(count + kTaps + kPadded, 0.0F);
  profile.weight.assign(count + kTaps + kPadded, 0.0F);
  const auto per_step = static_cast<float>(1.0 / profile.step_mm);
  const auto zero = static_cast<float>(kTaps) - static_cast<float>(profile.first_mm / profile.step_mm);
  addPixels(profile.pixels, per_step, zero, static_cast<float>(count + kTaps) + kFoot, profile.gray.data(),
            profile.weight.data());
  for (std::size_t i = 0; i < count; ++i) {
    const float w = profile.weight[i + kTaps];
    profile.weight[i] = w;
    profile.gray[i] = w > 0.0F ? profile.gray[i + kTaps] / w : 0.0F;
  }
  profile.gray.resize(count);
  profile.weight.resize(count);
}

}  // namespace

double caliperBorderPx(double reach_mm, double pixel_mm) {
  constexpr double kBorderPx = 4.0;
  return (reach_mm + 0.1) / pixel_mm * 1.05 + kBorderPx;
}

CaliperWindow windowOf(const Station& station, const EntityPlan& plan, double reach_mm) {
  CaliperWindow window{.p_S_mm = station.p_S_mm,
                       .tangent = station.tangent,
                       .curvature_per_mm = station.curvature_per_mm,
                       .back_mm = kWindowHalfMm,
                       .ahead_mm = kWindowHalfMm,
                       .reach_mm = reach_mm};
  const double bend = std::abs(station.curvature_per_mm);
  if (bend > kStraight_per_mm)
    window.back_mm = window.ahead_mm = std::min(kWindowHalfMm, kLongestArcRad / bend);
  if (!plan.closed) {
    window.back_mm = std::min(window.back_mm, station.station_mm);
    window.ahead_mm = std::min(window.ahead_mm, plan.length_mm - station.station_mm);
  }
  return window;
}

void readProfile(const TileView& view, const CameraCalibration& calibration, const PlaneMotion& X_TS,
                 const CaliperWindow& window, const OtherKerf& other, Profile& profile) {
  const GrayImage& image = view.tile.image;
  const LocalPixelMap map = calibration.localMap(X_TS * window.p_S_mm - view.tile.p_TV_mm);
  Eigen::Matrix2d window_axes;
  window_axes << window.tangent, Eigen::Vector2d(-window.tangent.y(), window.tangent.x());
  const Eigen::Matrix2d pixel_per_window = map.pixel_per_mm * X_TS.rotation() * window_axes;

  profile.pixel_mm = 1.0 / pixel_per_window.col(1).norm();
  profile.step_mm = profile.pixel_mm / kStepsPerPixel;
  const auto half = static_cast<std::size_t>(std::floor(window.reach_mm / profile.step_mm));
  profile.first_mm = -static_cast<double>(half) * profile.step_mm;
  const double even_light = 1.0 / view.light.at(map.pixel);
  profile.noise_gray = view.noise_gray * even_light;
  profile.pixels.clear();
  const WindowInPicture in_picture(window, map.pixel, pixel_per_window.inverse());
  if (image.bits == 8) {
    collect(image.pixels.data(), even_light, image, in_picture, profile.pixels);
  } else {
    collect(image.levels.data(), even_light / image.levelsPerGray(), image, in_picture, profile.pixels);
  }
  if (!other.p_S_mm.empty()) {
    std::erase_if(profile.pixels, [&](const PixelAcross& pixel) {
      const double a = pixel.along_mm;
      const double n = pixel.across_mm + 0.5 * window.curvature_per_mm * a * a;
      const Eigen::Vector2d p_S_mm = window.p_S_mm + window_axes * Eigen::Vector2d(a, n);
      return std::any_of(other.p_S_mm.begin(), other.p_S_mm.end(), [&](const Eigen::Vector2d& there) {
        return (there - p_S_mm).squaredNorm() < other.within_mm * other.within_mm;
      });
    });
  }
  spread(profile, 2 * half + 1);
}

}  // namespace kerfbench::vision

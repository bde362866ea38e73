// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_caliper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>

#include "hil/vision/kerf/kerf_sampling.h"
#include "twin/base/constants.h"

namespace kerfbench::vision {
namespace {

/// Least contrast of a kerf over that of board and open kerf; less is dirt or shading.
constexpr double kLeastContrast = 0.03;
constexpr std::array<double, 3> kLevels{0.4, 0.5, 0.6};

struct Peak {
  std::size_t first;  ///< First sample above half of its height.
  std::size_t last;
};

/// Calls found(first, last) for each run of seen samples above a level.
template <typename Found>
void runsAbove(const Profile& profile, std::size_t from, std::size_t to, double level, const Found& found) {
  const auto above = [&](std::size_t i) { return profile.seen(i) && profile.gray[i] > level; };
  std::size_t i = from;
  while (i <= to) {
    if (!above(i)) {
      ++i;
      continue;
    }
    const std::size_t first = i;
    while (i <= to && above(i)) ++i;
    found(first, i - 1);
  }
}

/// Sample position where the profile falls below the level, going out from a sample inside.
std::optional<double> crossing(const Profile& profile, std::size_t inside, int direction, double level) {
  std::size_t i = inside;
  while (profile.gray[i] >= level) {
    if ((direction < 0 && i == 0) || (direction > 0 && i + 1 == profile.size())) return std::nullopt;
    i = direction < 0 ? i - 1 : i + 1;
    if (!profile.seen(i)) return std::nullopt;
  }
  const std::size_t in = direction < 0 ? i + 1 : i - 1;
  if (in == i || !(profile.gray[in] > profile.gray[i])) return std::nullopt;
  const double share = (profile.gray[in] - level) / (profile.gray[in] - profile.gray[i]);
  return static_cast<double>(in) + direction * share;
}

/// Both flanks of the peak at `top`, where they cross a level.
using Edges = std::optional<std::array<double, 2>>;
Edges edgesAt(const Profile& profile, std::size_t top, double level) {
  if (profile.gray[top] < level) return std::nullopt;
  const auto left = crossing(profile, top, -1, level);
  const auto right = crossing(profile, top, +1, level);
  if (!left || !right) return std::nullopt;
  return std::array{*left, *right};
}

double widthOf(const Edges& edges, const Profile& profile) {
  return edges ? ((*edges)[1] - (*edges)[0]) * profile.step_mm : kNan;
}

/// Lower quartile: a kerf covers less than half of a caliper.
double boardOf(const Profile& profile) {
  static thread_local std::vector<float> sorted;
  sorted.clear();
  // The spline is wider than two samples: every other one has the same information.
  for (std::size_t i = 0; i < profile.size(); i += 2) {
    if (profile.seen(i)) sorted.push_back(profile.gray[i]);
  }
  if (sorted.size() < 6) return kNan;
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quartile, sorted.end());
  return *quartile;
}

/// Mean light of the pixels around a place, without the spline's blur; nullopt where there are too few.
std::optional<double> lightAt(const Profile& profile, double across_mm) {
  const auto half = static_cast<float>(kPeakPx * profile.pixel_mm);
  const auto at = static_cast<float>(across_mm);
  // Few of the pixels are so near: they are gathered first, without a branch, and added then.
  static thread_local std::vector<float> near;
  near.resize(profile.pixels.size() + 1);
  std::size_t count = 0;
  for (const PixelAcross& pixel : profile.pixels) {
    near[count] = pixel.gray;
    count += std::abs(pixel.across_mm - at) <= half ? 1U : 0U;
  }
  if (count < 2) return std::nullopt;
  const float sum = std::accumulate(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), 0.0F);
  return static_cast<double>(sum) / static_cast<double>(count);
}

double highest(const Profile& profile, std::size_t first, std::size_t last) {
  return *std::max_element(profile.gray.begin() + static_cast<std::ptrdiff_t>(first),
                           profile.gray.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

/// Kerfs that stand together are parted at half of the height of the highest; then the nearest counts.
std::optional<Peak> nearestPeak(const Profile& profile, double base, double least) {
  std::optional<Peak> nearest;
  double nearest_distance = std::numeric_limits<double>::infinity();
  const double middle = 0.5 * static_cast<double>(profile.size() - 1);
  runsAbove(profile, 0, profile.size() - 1, base + least, [&](std::size_t first, std::size_t last) {
    const double height = highest(profile, first, last) - base;
    runsAbove(profile, first, last, base + 0.5 * height, [&](std::size_t a, std::size_t b) {
      const double distance = std::abs(0.5 * static_cast<double>(a + b) - middle);
      if (distance >= nearest_distance) return;
      nearest_distance = distance;
      nearest = Peak{a, b};
    });
  });
  return nearest;
}

/// Left minus right at a distance from the centre.
double oddAt(const Profile& profile, double centre, double distance) {
  const auto at = [&](double place) {
    if (!(place >= 0.0) || place > static_cast<double>(profile.size()) - 1.001) return kNan;
    const auto i = static_cast<std::size_t>(place);
    if (!profile.seen(i) || !profile.seen(i + 1)) return kNan;
    const double t = place - static_cast<double>(i);
    return (1.0 - t) * profile.gray[i] + t * profile.gray[i + 1];
  };
  return at(centre + distance) - at(centre - distance);
}

/// Gray per mm, without its sign.
double slopeAt(const Profile& profile, double at) {
  const auto i = static_cast<std::size_t>(at);
  if (i < 1 || i + 2 >= profile.size()) return kNan;
  return std::abs(profile.gray[i + 2] - profile.gray[i - 1]) / (3.0 * profile.step_mm);
}

/// Noise of a flank's place: that of the profile over its slope.
double flankNoise(const Profile& profile, double at, double span_gray) {
  const double slope = slopeAt(profile, at);
  const auto i = static_cast<std::size_t>(at);
  if (!std::isfinite(slope)) return kNan;
  // A pixel counts for 0.394 (the spline's mean square weight over its mean) of the pixels per sample.
  const double pixels = std::max(1.0F, profile.weight[i]) / 0.394;
  // Light makes noise too: half as much variance again at the middle of a flank as on dim board is typical.
  return profile.noise_gray / std::sqrt(pixels) / std::max(slope, 1e-3 * span_gray / profile.pixel_mm);
}

}  // namespace

KerfReading measureKerf(const Profile& profile, double open_gray) {
  KerfReading reading{.offset_mm = kNan,
                      .width_mm = kNan,
                      .low_width_mm = kNan,
                      .high_width_mm = kNan,
                      .noise_mm = kNan,
                      .odd_gray = kNan,
                      .board_mm = kNan};
  const double base = boardOf(profile);
  if (!std::isfinite(base)) return reading;
  const double range = std::max(1.0, open_gray - base);
  reading.base_gray = base;
  const double least = std::max(2.0 * profile.noise_gray, kLeastContrast * range);
  const std::optional<Peak> peak = nearestPeak(profile, base, least);
  const auto nothing = [&] {
    // How bright it is at the nominal place.
    reading.brightness = std::clamp((lightAt(profile, 0.0).value_or(base) - base) / range, 0.0, 1.5);
    return reading;
  };
  if (!peak) return nothing();

  std::size_t top = peak->first;
  for (std::size_t i = peak->first; i <= peak->last; ++i) {
    if (profile.gray[i] > profile.gray[top]) top = i;
  }
  // The spline dims a narrow kerf: the pixels in its middle have its brightness.
  const double middle_mm =
      profile.first_mm + 0.5 * static_cast<double>(peak->first + peak->last) * profile.step_mm;
  reading.top_gray = std::max<double>(profile.gray[top], lightAt(profile, middle_mm).value_or(0.0));
  const double height = reading.top_gray - base;
  if (height < least) return nothing();
  const auto edges = [&](double share) { return edgesAt(profile, top, base + share * height); };
  const auto half = edges(0.5);
  if (!half) return nothing();  // Flank beyond the caliper.
  double centre = 0.0;
  int levels = 0;
  for (const double share : kLevels) {
    if (const auto at = edges(share)) {
      centre += 0.5 * ((*at)[0] + (*at)[1]);
      ++levels;
    }
  }
  reading.found = true;
  reading.offset_mm = profile.first_mm + centre / levels * profile.step_mm;
  reading.width_mm = ((*half)[1] - (*half)[0]) * profile.step_mm;
  reading.low_width_mm = widthOf(edges(0.25), profile);
  reading.high_width_mm = widthOf(edges(0.75), profile);
  reading.brightness = std::clamp(height / range, 0.0, 1.5);
  const double half_steps = 0.5 * ((*half)[1] - (*half)[0]);
  const double beside_steps = kBesidePx * profile.pixel_mm / profile.step_mm;
  reading.odd_gray = oddAt(profile, centre / levels, half_steps + beside_steps);
  const double steepness = 0.5 * (slopeAt(profile, (*half)[0]) + slopeAt(profile, (*half)[1]));
  reading.board_mm = 0.5 * oddAt(profile, centre / levels, kBoardMm / profile.step_mm) / steepness;
  reading.noise_mm =
      0.5 * std::hypot(flankNoise(profile, (*half)[0], height), flankNoise(profile, (*half)[1], height));
  return reading;
}

}  // namespace kerfbench::vision

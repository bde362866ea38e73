// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_caliper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace kerfbench::hil {
namespace {

constexpr int kLines = 5;
constexpr double kAlongMm = 0.1;
constexpr double kSamplesPerPixel = 3.0;
constexpr double kLeastContrast = 0.03;  // of board to open kerf; less is dirt or shading
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Catmull-Rom weights: exact for parabolas, so that a flank keeps its place between the pixels.
std::array<double, 4> cubicWeights(double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (-3.0 * t3 + 4.0 * t2 + t),
          0.5 * (t3 - t2)};
}

template <typename Level>
double sampleCubic(const Level* pixels, int width, const Eigen::Vector2d& p) {
  const double fx = std::floor(p.x());
  const double fy = std::floor(p.y());
  const int c = static_cast<int>(fx) - 1;
  const int r = static_cast<int>(fy) - 1;
  const auto wx = cubicWeights(p.x() - fx);
  const auto wy = cubicWeights(p.y() - fy);
  const auto stride = static_cast<std::size_t>(width);
  const Level* row = pixels + static_cast<std::size_t>(r) * stride + c;
  double sum = 0.0;
  for (std::size_t j = 0; j < 4; ++j, row += stride) {
    sum += wy[j] * (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
  }
  return sum;
}

double sampleGray(const GrayImage& image, const Eigen::Vector2d& p) {
  if (image.bits == 8) return sampleCubic(image.pixels.data(), image.width, p);
  return sampleCubic(image.levels.data(), image.width, p) / image.levelsPerGray();
}

struct Peak {
  std::size_t first;  ///< Of the samples above half of its height.
  std::size_t last;
  double height;  ///< Above the baseline.
};

double smoothed(const std::vector<double>& gray, std::size_t i) {
  const std::size_t before = i == 0 ? i : i - 1;
  const std::size_t after = std::min(gray.size() - 1, i + 1);
  return (gray[before] + gray[i] + gray[after]) / 3.0;
}

double highest(const std::vector<double>& gray, std::size_t first, std::size_t last, double base) {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i <= last; ++i) top = std::max(top, smoothed(gray, i));
  return top - base;
}

/// Calls found(first, last) for each run of samples in [from, to] above a level.
template <typename Found>
void runsAbove(const std::vector<double>& gray, std::size_t from, std::size_t to, double level,
               const Found& found) {
  std::size_t i = from;
  while (i <= to) {
    if (gray[i] <= level) {
      ++i;
      continue;
    }
    const std::size_t first = i;
    while (i <= to && gray[i] > level) ++i;
    found(first, i - 1);
  }
}

/// Sample position where the profile falls below the level, going out from a sample inside.
std::optional<double> crossing(const std::vector<double>& gray, std::size_t inside, int direction,
                               double level) {
  std::size_t i = inside;
  while (gray[i] >= level) {
    if ((direction < 0 && i == 0) || (direction > 0 && i + 1 == gray.size())) return std::nullopt;
    i = direction < 0 ? i - 1 : i + 1;
  }
  const std::size_t in = direction < 0 ? i + 1 : i - 1;
  const double share = (gray[in] - level) / (gray[in] - gray[i]);
  return static_cast<double>(in) + direction * share;
}

}  // namespace

void readProfile(const TileView& view, const CameraCalibration& calibration, const PlaneMotion& X_TS,
                 const Station& station, const EntityPlan& plan, double reach_mm, Profile& profile) {
  const Eigen::Vector2d p_V_mm = X_TS * station.p_S_mm - view.tile.p_TV_mm;
  const LocalPixelMap map = calibration.localMap(p_V_mm);
  const Eigen::Matrix2d pixel_per_S = map.pixel_per_mm * X_TS.rotation();
  const Eigen::Vector2d tangent = station.tangent;
  const Eigen::Vector2d normal(-tangent.y(), tangent.x());

  profile.step_mm = 1.0 / (kSamplesPerPixel * (pixel_per_S * normal).norm());
  const auto half = static_cast<std::size_t>(std::floor(reach_mm / profile.step_mm));
  profile.first_mm = -static_cast<double>(half) * profile.step_mm;
  profile.gray.assign(2 * half + 1, 0.0);
  profile.noise_gray = view.noise_gray / std::sqrt(static_cast<double>(kLines));

  const double back = plan.closed ? -kAlongMm : std::max(-kAlongMm, -station.station_mm);
  const double ahead = plan.closed ? kAlongMm : std::min(kAlongMm, plan.length_mm - station.station_mm);
  for (int line = 0; line < kLines; ++line) {
    const double along_mm = back + (ahead - back) * line / (kLines - 1);
    const double turn = station.curvature_per_mm * along_mm;
    const Eigen::Vector2d start_mm = along_mm * tangent + 0.5 * turn * along_mm * normal;
    const Eigen::Vector2d direction = (normal - turn * tangent).normalized();
    const Eigen::Vector2d step_px = pixel_per_S * direction * profile.step_mm;
    const Eigen::Vector2d from_px = map.pixel + pixel_per_S * (start_mm + profile.first_mm * direction);
    for (std::size_t i = 0; i < profile.gray.size(); ++i) {
      profile.gray[i] += sampleGray(view.tile.image, from_px + static_cast<double>(i) * step_px);
    }
  }
  for (double& g : profile.gray) g /= kLines;
}

void measureKerf(const Profile& profile, double open_gray, Caliper& caliper) {
  caliper.found = false;
  caliper.offset_mm = kNan;
  caliper.width_mm = kNan;
  caliper.brightness = 0.0;
  const std::vector<double>& gray = profile.gray;
  if (gray.size() < 8) return;

  // A kerf covers less than half of a caliper; the lower quartile is board.
  std::vector<double> sorted = gray;
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quartile, sorted.end());
  const double base = *quartile;
  const double range = std::max(1.0, open_gray - base);
  caliper.brightness = std::clamp((smoothed(gray, gray.size() / 2) - base) / range, 0.0,
                                  1.5);  // where nothing is found: at nominal
  const double least = std::max(6.0 * profile.noise_gray, kLeastContrast * range);

  // Kerfs that stand together are parted at half of the height of the highest; then the nearest counts.
  std::optional<Peak> nearest;
  double nearest_distance = std::numeric_limits<double>::infinity();
  const double middle = 0.5 * static_cast<double>(gray.size() - 1);
  runsAbove(gray, 0, gray.size() - 1, base + least, [&](std::size_t first, std::size_t last) {
    const double height = highest(gray, first, last, base);
    runsAbove(gray, first, last, base + 0.5 * height, [&](std::size_t a, std::size_t b) {
      const double distance = std::abs(0.5 * static_cast<double>(a + b) - middle);
      if (distance >= nearest_distance) return;
      nearest_distance = distance;
      nearest = Peak{a, b, highest(gray, a, b, base)};
    });
  });
  if (!nearest || nearest->height < least) return;

  std::size_t top = nearest->first;
  for (std::size_t i = nearest->first; i <= nearest->last; ++i) {
    if (smoothed(gray, i) > smoothed(gray, top)) top = i;
  }
  const auto edges = [&](double share) -> std::optional<std::array<double, 2>> {
    const double level = base + share * nearest->height;
    if (gray[top] < level) return std::nullopt;
    const auto left = crossing(gray, top, -1, level);
    const auto right = crossing(gray, top, +1, level);
    if (!left || !right) return std::nullopt;
    return std::array{*left, *right};
  };
  const auto half = edges(0.5);
  if (!half) return;  // It runs out of the caliper.
  double centre = 0.0;
  int levels = 0;
  for (const double share : {0.4, 0.5, 0.6}) {
    if (const auto at = edges(share)) {
      centre += 0.5 * ((*at)[0] + (*at)[1]);
      ++levels;
    }
  }
  caliper.found = true;
  caliper.offset_mm = profile.first_mm + centre / levels * profile.step_mm;
  caliper.width_mm = ((*half)[1] - (*half)[0]) * profile.step_mm;
  caliper.brightness = std::clamp(nearest->height / range, 0.0, 1.5);
}

}  // namespace kerfbench::hil

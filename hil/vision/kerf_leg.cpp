// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_leg.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::hil {
namespace {

constexpr double kLegMm = 1.7;
constexpr double kIndependentMm = 0.2;  // Calipers that far apart share no pixels.

}  // namespace

std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm) {
  double n = 0.0;
  double s = 0.0;
  double ss = 0.0;
  double y = 0.0;
  double sy = 0.0;
  double variance = 0.0;
  KerfLeg leg;
  for (const Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - station_mm);
    if (!c.found || c.near_joint || away_mm < from_mm || away_mm > from_mm + kLegMm) continue;
    n += 1.0;
    s += away_mm;
    ss += away_mm * away_mm;
    y += c.offset_mm;
    sy += away_mm * c.offset_mm;
    leg.half_width_mm += 0.5 * c.width_mm;
    leg.brightness += c.brightness;
    variance += c.sigma_mm * c.sigma_mm;
  }
  if (n < 2.0) return std::nullopt;
  leg.half_width_mm /= n;
  leg.brightness /= n;
  leg.sigma_mm = std::sqrt(variance / n);
  const double spread = ss - s * s / n;
  // A short leg does not tell a direction.
  const bool directed = spread > 0.4 * n * kLegMm * kLegMm / 12.0;
  const double slope = directed ? (sy - s * y / n) / spread : 0.0;
  leg.offset_mm = (y - slope * s) / n;
  const double pitch_mm = std::abs(kerf.calipers.back().station_mm - kerf.calipers.front().station_mm) /
                          std::max(1.0, static_cast<double>(kerf.calipers.size()) - 1.0);
  const double dependent = std::max(1.0, kIndependentMm / std::max(pitch_mm, 1e-6));
  const double carried = directed ? s * s / (n * n * spread) : 0.0;
  leg.offset_sigma_mm = leg.sigma_mm * std::sqrt(std::min(1.0, dependent * (1.0 / n + carried)));
  return leg;
}

}  // namespace kerfbench::hil

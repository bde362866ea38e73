// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_leg.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace kerfbench::vision {
namespace {

constexpr double kLegMm = 1.7;
constexpr double kStatedShare =
    0.5;  // A width's stated variance holds more than scatter from one to the next.

}  // namespace

std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm) {
  std::vector<LegReading> readings;
  std::vector<double> half_widths_mm;
  double variance = 0.0;
  double width_variance = 0.0;
  double mean_mm = 0.0;
  double farthest_mm = from_mm;
  double nearest_mm = from_mm + kLegMm;
  KerfLeg leg;
  for (const Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - station_mm);
    if (!c.found || c.near_joint || away_mm < from_mm || away_mm > from_mm + kLegMm) continue;
    readings.push_back({away_mm, c.offset_mm, c.sigma_mm});
    half_widths_mm.push_back(0.5 * (c.width_mm + kerf.widening_mm));
    farthest_mm = std::max(farthest_mm, away_mm);
    nearest_mm = std::min(nearest_mm, away_mm);
    mean_mm += c.offset_mm;
    leg.half_width_mm += half_widths_mm.back();
    leg.brightness += c.brightness;
    variance += c.sigma_mm * c.sigma_mm;
    width_variance += 0.25 * c.width_sigma_mm * c.width_sigma_mm;
  }
  const auto n = static_cast<double>(readings.size());
  if (readings.size() < kFewestOnLeg) return std::nullopt;
  leg.half_width_mm /= n;
  leg.brightness /= n;
  leg.sigma_mm = std::sqrt(variance / n);
  double flicker = 0.0;
  for (const double half_mm : half_widths_mm)
    flicker += (half_mm - leg.half_width_mm) * (half_mm - leg.half_width_mm) / (n - 1.0);
  leg.flicker_mm = std::sqrt(std::max(0.0, flicker - kStatedShare * width_variance / n));
  // A short leg has no measurable direction.
  const bool directed = readings.size() > 3 && farthest_mm - nearest_mm > 0.6 * kLegMm;
  leg.offset_mm = directed ? polynomialThrough(readings, 1)[0] : mean_mm / n;
  return leg;
}

std::vector<LegReading> readingsBeside(const EntityKerf& kerf, double station_mm, double from_mm,
                                       double to_mm) {
  std::vector<LegReading> readings;
  for (const Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - station_mm);
    if (c.found && !c.near_joint && away_mm >= from_mm && away_mm <= to_mm)
      readings.push_back({away_mm, c.offset_mm, c.sigma_mm});
  }
  return readings;
}

Eigen::VectorXd polynomialThrough(const std::vector<LegReading>& readings, Eigen::Index degree) {
  const auto n = static_cast<Eigen::Index>(readings.size());
  Eigen::MatrixXd basis(n, degree + 1);
  Eigen::VectorXd offsets(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const LegReading& r = readings[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k <= degree; ++k) basis(i, k) = std::pow(r.away_mm, static_cast<double>(k));
    offsets[i] = r.offset_mm;
  }
  return basis.householderQr().solve(offsets);
}

std::optional<EndLine> besideEnd(const EntityKerf& kerf, double station_mm) {
  constexpr double kFromMm = 0.12;
  constexpr double kToMm = 0.5;
  const std::vector<LegReading> readings = readingsBeside(kerf, station_mm, kFromMm, kToMm);
  if (readings.size() < 3) return std::nullopt;
  const Eigen::VectorXd line = polynomialThrough(readings, 1);
  return EndLine{line[0], line[1]};
}

}  // namespace kerfbench::vision

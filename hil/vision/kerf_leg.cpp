// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_leg.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace kerfbench::hil {
namespace {

constexpr double kLegMm = 1.7;
constexpr double kBentLegMm = 0.8;
constexpr double kBent = 2.0;           // Scatter about a straight line, in sigma, from where a leg is bent.
constexpr double kBentShare = 0.15;     // Of what the bend makes at the joint: what a parabola leaves.
constexpr double kIndependentMm = 0.2;  // Calipers that far apart share no pixels.

struct Reading {
  double away_mm, offset_mm;
};

/// A polynomial through readings, carried on to the joint.
struct Carried {
  double offset_mm{};
  double factor{};   ///< Its variance over that of one reading.
  double scatter{};  ///< RMS of what is left, mm.
};

Carried carryOn(const std::vector<Reading>& readings, double to_mm, Eigen::Index degree) {
  std::vector<Reading> some;
  for (const Reading& r : readings) {
    if (r.away_mm <= to_mm) some.push_back(r);
  }
  const auto n = static_cast<Eigen::Index>(some.size());
  Eigen::MatrixXd basis(n, degree + 1);
  Eigen::VectorXd offset(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Reading& r = some[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k <= degree; ++k) basis(i, k) = std::pow(r.away_mm, static_cast<double>(k));
    offset[i] = r.offset_mm;
  }
  const Eigen::MatrixXd inverse = (basis.transpose() * basis).inverse();
  const Eigen::VectorXd fit = inverse * (basis.transpose() * offset);
  return {fit[0], inverse(0, 0),
          std::sqrt((offset - basis * fit).squaredNorm() /
                    static_cast<double>(std::max<Eigen::Index>(1, n - degree - 1)))};
}

}  // namespace

std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm, bool beside_corner) {
  std::vector<Reading> readings;
  double variance = 0.0;
  double mean_mm = 0.0;
  double farthest_mm = 0.0;
  double nearest_mm = from_mm + kLegMm;
  KerfLeg leg;
  for (const Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - station_mm);
    const bool reads = c.found && (beside_corner ? std::isfinite(c.offset_mm) : !c.near_joint);
    if (!reads || away_mm < from_mm || away_mm > from_mm + kLegMm) continue;
    readings.push_back({away_mm, c.offset_mm});
    farthest_mm = std::max(farthest_mm, away_mm);
    nearest_mm = std::min(nearest_mm, away_mm);
    mean_mm += c.offset_mm;
    leg.half_width_mm += 0.5 * (c.width_mm + kerf.widening_mm);
    leg.brightness += c.brightness;
    variance += c.sigma_mm * c.sigma_mm;
  }
  const auto n = static_cast<double>(readings.size());
  if (readings.size() < 2) return std::nullopt;
  leg.half_width_mm /= n;
  leg.brightness /= n;
  leg.sigma_mm = std::sqrt(variance / n);
  const double pitch_mm = kerf.calipers.back().station_mm / (static_cast<double>(kerf.calipers.size()) - 1.0);
  const double dependent = std::max(1.0, kIndependentMm / pitch_mm);
  // A short leg does not tell a direction, let alone a bend.
  const bool directed = readings.size() > 3 && farthest_mm - nearest_mm > 0.6 * kLegMm;
  const Carried straight = directed ? carryOn(readings, farthest_mm, 1) : Carried{mean_mm / n, 1.0 / n, 0.0};
  leg.offset_mm = straight.offset_mm;
  leg.offset_sigma_mm = leg.sigma_mm * std::sqrt(std::min(4.0, dependent * straight.factor));
  const double bent_to_mm = nearest_mm + kBentLegMm;
  const auto kept = std::count_if(readings.begin(), readings.end(),
                                  [&](const Reading& r) { return r.away_mm <= bent_to_mm; });
  if (straight.scatter > kBent * leg.sigma_mm && kept > 4) {
    const Carried bent = carryOn(readings, bent_to_mm, 2);
    leg.offset_mm = bent.offset_mm;
    leg.offset_sigma_mm = std::hypot(leg.sigma_mm * std::sqrt(dependent * bent.factor),
                                     kBentShare * (bent.offset_mm - straight.offset_mm));
  }
  return leg;
}

std::optional<double> besideEnd(const EntityKerf& kerf, double station_mm) {
  constexpr double kFromMm = 0.12;
  constexpr double kToMm = 0.5;
  std::vector<Reading> readings;
  for (const Caliper& c : kerf.calipers) {
    const double away_mm = std::abs(c.station_mm - station_mm);
    if (c.found && !c.near_joint && away_mm >= kFromMm && away_mm <= kToMm)
      readings.push_back({away_mm, c.offset_mm});
  }
  if (readings.size() < 3) return std::nullopt;
  return carryOn(readings, kToMm, 1).offset_mm;
}

}  // namespace kerfbench::hil

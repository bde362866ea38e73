// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/checks/set_off.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::inspect::checks {
namespace {

/// Lengths of ramps that are tried: the first, and how much longer each is than the one before.
constexpr double kShortestRamp_mm = 1.25 * kNearest_mm;
constexpr double kLonger = 1.15;
/// How often the search around the best of these takes the root of the ratio of its step: down to 0.05 %.
constexpr int kRefinements = 8;
/// A ramp that is longer than so much of what was seen is told from an endless one by noise alone.
constexpr double kSeenShare = 0.8;

double triedRamp_mm(int index) { return kShortestRamp_mm * std::pow(kLonger, index); }

double farthestWay_mm(const std::vector<Place>& places, double rest_mm) {
  double farthest_mm = 0.0;
  for (const Place& p : places) farthest_mm = std::max(farthest_mm, p.way_mm - rest_mm);
  return farthest_mm;
}

SetOffFit fitRampOver(const std::vector<Place>& places, double ramp_mm, double rest_mm) {
  return fitSetOff(places, SetOff::rampOver(ramp_mm), rest_mm);
}

/// Adds what the length of the ramp leaves open: by how chi square and t0 change with its logarithm.
void addRampLength(const std::vector<Place>& places, double rest_mm, RampFit& ramp) {
  constexpr double kStep = 0.05;
  const SetOffFit longer = fitRampOver(places, ramp.ramp_mm * (1.0 + kStep), rest_mm);
  const SetOffFit shorter = fitRampOver(places, ramp.ramp_mm / (1.0 + kStep), rest_mm);
  const double curvature =
      (longer.chi_square + shorter.chi_square - 2.0 * ramp.fit.chi_square) / (kStep * kStep);
  const double by_length_s = 0.5 * (longer.t0_s - shorter.t0_s) / kStep;
  ramp.fit.sigma_s = curvature > 0.0 ? std::hypot(ramp.fit.sigma_s, by_length_s * std::sqrt(2.0 / curvature))
                                     : std::numeric_limits<double>::infinity();
}

}  // namespace

double SetOff::timeAt(double way_mm) const {
  if (way_mm > ramp_mm_) return 0.5 * (way_mm / ramp_mm_ + 1.0);
  return std::isinf(ramp_mm_) ? std::pow(way_mm, 1.0 / power_) : std::sqrt(way_mm / ramp_mm_);
}

double SetOff::wayAt(double time) const {
  if (std::isinf(ramp_mm_)) return std::pow(time, power_);
  return ramp_mm_ * (time > 1.0 ? 2.0 * time - 1.0 : time * time);
}

double SetOff::speedAt(double way_mm) const {
  if (std::isinf(ramp_mm_)) return power_ * std::pow(way_mm, 1.0 - 1.0 / power_);
  return 2.0 * ramp_mm_ * std::sqrt(std::min(way_mm / ramp_mm_, 1.0));
}

SetOffFit fitSetOff(const std::vector<Place>& places, const SetOff& law, double rest_mm) {
  double sw = 0, st = 0, sy = 0, stt = 0, sty = 0;
  const auto wayOf = [&](const Place& p) { return p.way_mm - rest_mm; };
  const auto weightOf = [&](const Place& p) {
    const double slope = law.speedAt(wayOf(p)) / p.sigma_mm;
    return slope * slope;
  };
  for (const Place& p : places) {
    if (wayOf(p) < kNearest_mm) continue;
    const double weight = weightOf(p);
    const double y = law.timeAt(wayOf(p));
    sw += weight;
    st += weight * p.t_s;
    sy += weight * y;
    stt += weight * p.t_s * p.t_s;
    sty += weight * p.t_s * y;
  }
  const double determinant = sw * stt - st * st;
  const double slope = (sw * sty - st * sy) / determinant;
  const double offset = (stt * sy - st * sty) / determinant;
  if (!(slope > 0)) return {};
  SetOffFit fit{-offset / slope, 0.0, 0.0, law.wayAt(std::max(offset, 0.0))};
  for (const Place& p : places) {
    const double expected = std::max(offset + slope * p.t_s, 0.0);
    if (wayOf(p) < kNearest_mm) {
      const double off = (wayOf(p) - law.wayAt(expected)) / p.sigma_mm;
      fit.chi_square += off * off;
    } else {
      const double off = law.timeAt(wayOf(p)) - offset - slope * p.t_s;
      fit.chi_square += weightOf(p) * off * off;
    }
  }
  const double variance =
      (stt + sw * fit.t0_s * fit.t0_s - 2.0 * st * fit.t0_s) / determinant / (slope * slope);
  fit.sigma_s = std::sqrt(std::max(variance, 0.0));
  return fit;
}

RampFit fitRamp(const std::vector<Place>& places, double rest_mm) {
  const double longest_mm = kSeenShare * farthestWay_mm(places, rest_mm);
  RampFit best;
  const auto take = [&](double ramp_mm) {
    const SetOffFit fit = fitRampOver(places, ramp_mm, rest_mm);
    if (fit.chi_square < best.fit.chi_square) best = {ramp_mm, fit};
  };
  for (int i = 0; triedRamp_mm(i) <= longest_mm; ++i) take(triedRamp_mm(i));
  if (!(best.ramp_mm > 0.0)) return best;
  double step = kLonger;
  for (int i = 0; i < kRefinements; ++i) {
    step = std::sqrt(step);
    const double from_mm = best.ramp_mm;
    take(from_mm * step);
    take(from_mm / step);
  }
  addRampLength(places, rest_mm, best);
  return best;
}

bool rampExplains(const std::vector<Place>& places, double rest_mm, const SetOffFit& at_once) {
  const auto explains = [&](const SetOffFit& fit) {
    return std::abs(fit.t0_s) < 0.5 * at_once.t0_s && fit.chi_square < at_once.chi_square + kClearlyBetter;
  };
  if (explains(fitSetOff(places, SetOff::byPower(2.0), rest_mm))) return true;
  const double farthest_mm = farthestWay_mm(places, rest_mm);
  for (int i = 0; triedRamp_mm(i) <= farthest_mm; ++i) {
    if (explains(fitRampOver(places, triedRamp_mm(i), rest_mm))) return true;
  }
  return false;
}

}  // namespace kerfbench::inspect::checks

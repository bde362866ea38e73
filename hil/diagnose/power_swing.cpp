// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/power_swing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace kerfbench::diagnose {
namespace {

constexpr double kSteady = 0.05;                       // Share by which the speed may change.
constexpr std::size_t kShortest = 40;                  // Spans: 20 ms.
constexpr std::size_t kLeastHalf = 3, kMostHalf = 30;  // Spans of half a period: 1.5 to 15 ms.
/// Autocorrelation half a period and a whole one later. Noise has 0 at both; a sine has -1 and 1, less the
/// more its period wanders.
constexpr double kOpposite = -0.35, kBack = 0.2;
constexpr double kFewestPeriods = 10.0;
constexpr double kLeastSwing = 0.05;

/// Power over speed less its mean, by the mean, in one stretch of even speed.
using Stretch = std::vector<double>;

Stretch departures(const PowerRun& run, std::size_t begin, std::size_t end) {
  Stretch of;
  for (std::size_t i = begin; i < end; ++i) of.push_back(run.light_share[i] / run.speed_mm_s[i]);
  const double mean = std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
  if (!(mean > 0.0)) return {};
  for (double& share : of) share = share / mean - 1.0;
  return of;
}

/// Stretches of a run in which the speed stays within kSteady of that of their begins.
void addStretches(const PowerRun& run, std::vector<Stretch>& stretches) {
  const std::size_t count = std::min(run.light_share.size(), run.speed_mm_s.size());
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin;
    const double speed = run.speed_mm_s[begin];
    while (end < count && speed > 0.0 && std::abs(run.speed_mm_s[end] / speed - 1.0) <= kSteady) ++end;
    if (end - begin >= kShortest) {
      if (Stretch of = departures(run, begin, end); !of.empty()) stretches.push_back(std::move(of));
    }
    begin = std::max(end, begin + 1);
  }
}

/// Mean product of what lies `lag` spans apart, within the stretches.
double covariance(const std::vector<Stretch>& stretches, std::size_t lag) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Stretch& of : stretches) {
    for (std::size_t i = lag; i < of.size(); ++i) sum += of[i] * of[i - lag];
    count += of.size() > lag ? of.size() - lag : 0;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace

std::optional<PowerSwing> powerSwing(const std::vector<PowerRun>& runs) {
  std::vector<Stretch> stretches;
  for (const PowerRun& run : runs) addStretches(run, stretches);
  const double variance = covariance(stretches, 0);
  if (!(std::sqrt(2.0 * variance) >= kLeastSwing)) return std::nullopt;
  std::size_t half = 1;
  double lowest = 0.0;
  for (std::size_t lag = 1; lag <= kMostHalf; ++lag) {
    const double now = covariance(stretches, lag) / variance;
    if (now < lowest) {
      lowest = now;
      half = lag;
    } else if (lowest < kOpposite) {
      break;  // The first turn, not one of its multiples.
    }
  }
  if (lowest > kOpposite || half < kLeastHalf || half >= kMostHalf) return std::nullopt;
  std::size_t whole = 2 * half;
  double back = -1.0;
  for (std::size_t lag = 2 * half - 2; lag <= 2 * half + 2; ++lag) {
    const double now = covariance(stretches, lag) / variance;
    if (now > back) {
      back = now;
      whole = lag;
    }
  }
  double spans = 0.0;
  for (const Stretch& of : stretches) spans += static_cast<double>(of.size());
  const double periods = spans / static_cast<double>(whole);
  if (back < kBack || periods < kFewestPeriods) return std::nullopt;
  const double share = std::sqrt(2.0 * variance);
  // The variance of n independent halves of a swing is known to sqrt(2/n); of its root, half of that.
  return PowerSwing{share, 2.0 * share * 0.5 * std::sqrt(2.0 / (2.0 * periods)),
                    static_cast<double>(whole) * kPowerSpan_s};
}

}  // namespace kerfbench::diagnose

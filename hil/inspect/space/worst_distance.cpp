// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/space/worst_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kHalfWindow = 1;
constexpr std::size_t kHalfTrend = 5;
constexpr std::uint64_t kDraws = 400;
constexpr std::uint64_t kNoiseStream = 0x7370616365ULL;

bool neighbours(const EdgeReading& a, const EdgeReading& b) {
  return a.line == b.line && std::abs(b.way_mm - a.way_mm) < 1.5 * kEdgePitch_mm;
}

/// First and last reading of the window round `at` that may be averaged.
std::pair<std::size_t, std::size_t> windowOf(const std::vector<EdgeReading>& readings, std::size_t at,
                                             std::size_t half) {
  const auto joins = [&](std::size_t from, std::size_t to) {
    return readings[to].found && readings[to].zone == readings[at].zone &&
           neighbours(readings[from], readings[to]);
  };
  // As far to one side as to the other, or a slope would shift the mean.
  std::size_t reach = 0;
  while (reach < half && at >= reach + 1 && at + reach + 1 < readings.size() &&
         joins(at - reach, at - reach - 1) && joins(at + reach, at + reach + 1))
    ++reach;
  return {at - reach, at + reach};
}

/// Largest of simulated measurements of a truth that has noise alone.
std::vector<double> simulatedWorsts(const std::vector<EdgeReading>& readings,
                                    const std::vector<std::size_t>& judged,
                                    const std::vector<Vector2d>& truth, std::uint64_t seed) {
  std::vector<double> sigma_mm;
  for (const std::size_t i : judged) sigma_mm.push_back(meanReading(readings, i, kHalfWindow).noise_mm);
  std::vector<double> worsts;
  const CounterRandom random(seed, kNoiseStream);
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    double worst_mm = 0.0;
    for (std::size_t i = 0; i < judged.size(); ++i) {
      const double noise_mm = sigma_mm[i] * random.normal(draw * judged.size() + i);
      worst_mm = std::max(worst_mm, std::hypot(truth[i].x() + noise_mm, truth[i].y()));
    }
    worsts.push_back(worst_mm);
  }
  return worsts;
}

}  // namespace

MeanReading meanReading(const std::vector<EdgeReading>& readings, std::size_t at, std::size_t half) {
  const auto [first, last] = windowOf(readings, at, half);
  const auto n = static_cast<double>(last - first + 1);
  MeanReading mean;
  double square = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    mean.beside_mm += readings[i].beside_mm / n;
    mean.above_mm += readings[i].above_mm / n;
    square += readings[i].noise_mm * readings[i].noise_mm;
  }
  mean.noise_mm = std::sqrt(square) / n;
  return mean;
}

double sharedU_mm(const EdgeReading& reading, const Vector2d& direction) {
  const double length = direction.norm();
  const Vector2d d = length > 0.0 ? Vector2d(direction / length) : Vector2d::UnitX();
  return (d.x() * reading.beside_modes + d.y() * reading.above_modes).norm();
}

WorstDistance worstDistance(const std::vector<EdgeReading>& readings, std::uint64_t seed) {
  WorstDistance worst;
  std::vector<std::size_t> judged;
  std::vector<Vector2d> truth;
  double truth_mm = 0.0;
  worst.as_read_mm = -1.0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].zone != EdgeZone::kAlong || !readings[i].found) continue;
    judged.push_back(i);
    const MeanReading trend = meanReading(readings, i, kHalfTrend);
    truth.emplace_back(trend.beside_mm, trend.above_mm);
    truth_mm = std::max(truth_mm, truth.back().norm());
    const MeanReading mean = meanReading(readings, i, kHalfWindow);
    const Vector2d off(mean.beside_mm, mean.above_mm);
    const double shared_u_mm = sharedU_mm(readings[i], off);
    const double U_mm = 2.0 * std::hypot(mean.noise_mm, shared_u_mm);
    worst.most_mm = std::max(worst.most_mm, off.norm() + U_mm);
    if (judged.size() == 1 || off.norm() - U_mm > worst.surest.value - worst.surest.U) {
      worst.surest = {off.norm(), U_mm};
      worst.surest_reading = i;
    }
    if (off.norm() <= worst.as_read_mm) continue;
    worst.as_read_mm = off.norm();
    worst.shared_u_mm = shared_u_mm;
    worst.reading = i;
  }
  worst.readings = judged.size();
  if (judged.empty()) return worst;
  const Quantity noise =
      basicInterval(worst.as_read_mm, truth_mm, simulatedWorsts(readings, judged, truth, seed), 0.0);
  const EdgeReading& at = readings[worst.reading];
  const MeanReading mean = meanReading(readings, worst.reading, kHalfWindow);
  const Vector2d d = Vector2d(mean.beside_mm, mean.above_mm) / std::max(worst.as_read_mm, 1e-12);
  worst.noise_u_mm = std::max(0.5 * noise.U, std::abs(d.x()) * mean.noise_mm);
  for (std::size_t k = 0; k < at.sources.size(); ++k) {
    const auto mode = static_cast<Eigen::Index>(k);
    const double u_mm = d.x() * at.beside_modes[mode] + d.y() * at.above_modes[mode];
    double& sum = worst.source_u_mm.at(at.sources[k]);
    sum = std::hypot(sum, u_mm);
  }
  worst.value = {noise.value, 2.0 * std::hypot(worst.noise_u_mm, worst.shared_u_mm)};
  return worst;
}

}  // namespace kerfbench::inspect

// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/s_curve.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::planner {

double Ramp::durationS(double v0_mm_s, double v1_mm_s) const {
  const double change = std::abs(v1_mm_s - v0_mm_s);
  const double a = acceleration_mm_s2;
  if (jerk_mm_s3 <= 0.0) return change / a;
  if (change * jerk_mm_s3 >= a * a) return change / a + a / jerk_mm_s3;
  return 2.0 * std::sqrt(change / jerk_mm_s3);
}

double Ramp::travelMm(double v0_mm_s, double v1_mm_s) const {
  if (jerk_mm_s3 <= 0.0) return std::abs(v1_mm_s * v1_mm_s - v0_mm_s * v0_mm_s) / (2.0 * acceleration_mm_s2);
  return 0.5 * (v0_mm_s + v1_mm_s) * durationS(v0_mm_s, v1_mm_s);
}

double Ramp::mostTravelMm(double v0_mm_s, double v1_mm_s) const {
  if (jerk_mm_s3 <= 0.0) return travelMm(v0_mm_s, v1_mm_s);
  // The maximum of (w + v) sqrt((w - v)/j) over v is at w/3, that of (w² - v²)/2a + (w + v) a/2j at a²/2j.
  const double high = std::max(v0_mm_s, v1_mm_s);
  const double longest = std::min(high / 3.0, acceleration_mm_s2 * acceleration_mm_s2 / (2.0 * jerk_mm_s3));
  return travelMm(std::max(std::min(v0_mm_s, v1_mm_s), longest), high);
}

double Ramp::peakMmS(double length_mm, double v0_mm_s, double v1_mm_s, double limit_mm_s) const {
  const double least = std::max(v0_mm_s, v1_mm_s);
  const double without_jerk =
      std::sqrt(acceleration_mm_s2 * length_mm + 0.5 * (v0_mm_s * v0_mm_s + v1_mm_s * v1_mm_s));
  const double peak = std::max(least, std::min(limit_mm_s, without_jerk));
  if (jerk_mm_s3 <= 0.0) return peak;
  return highest(least, peak,
                 [&](double top) { return travelMm(v0_mm_s, top) + travelMm(top, v1_mm_s) - length_mm; });
}

void Ramp::addPhases(double v0_mm_s, double v1_mm_s, double s0_mm, std::vector<Phase>& phases) const {
  const double sense = v1_mm_s >= v0_mm_s ? 1.0 : -1.0;
  const double change = std::abs(v1_mm_s - v0_mm_s);
  const double a = acceleration_mm_s2;
  const double j = jerk_mm_s3;
  if (j <= 0.0) {
    phases.push_back({s0_mm, v0_mm_s, sense * a, 0.0, change / a});
    return;
  }
  const double top_a = std::min(a, std::sqrt(change * j));
  const double bow_s = top_a / j;
  const double level_s = top_a > 0.0 ? std::max(0.0, change / top_a - bow_s) : 0.0;
  double s_mm = s0_mm;
  double v = v0_mm_s;
  const auto add = [&](double from_a, double jerk, double t) {
    phases.push_back({s_mm, v, from_a, jerk, t});
    s_mm += phases.back().travelMm(t);
    v += t * (from_a + 0.5 * t * jerk);
  };
  add(0.0, sense * j, bow_s);
  add(sense * top_a, 0.0, level_s);
  add(sense * top_a, -sense * j, bow_s);
}

double durationOf(const std::vector<Phase>& phases) {
  double total_s = 0.0;
  for (const Phase& phase : phases) total_s += phase.duration_s;
  return total_s;
}

std::vector<double> stationsOf(const std::vector<Phase>& phases, int periods, double total_mm) {
  const double total_s = durationOf(phases);
  std::vector<double> stations{0.0};
  std::size_t at = 0;
  double begun_s = 0.0;
  for (int k = 1; k < periods; ++k) {
    const double t_s = total_s * k / periods;
    while (at + 1 < phases.size() && t_s > begun_s + phases[at].duration_s)
      begun_s += phases[at++].duration_s;
    const Phase& phase = phases[at];
    stations.push_back(std::clamp(phase.s_mm + phase.travelMm(t_s - begun_s), stations.back(), total_mm));
  }
  stations.push_back(total_mm);
  return stations;
}

}  // namespace kerfbench::planner

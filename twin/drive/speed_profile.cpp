// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerfbench::twin {

SpeedProfile::SpeedProfile(double start_speed_mm_s, const std::vector<SpeedPoint>& changes) {
  knots_.push_back({{0.0, start_speed_mm_s}, 0.0});
  bool fine = std::isfinite(start_speed_mm_s);
  for (const SpeedPoint& next : changes) {
    const Knot& last = knots_.back();
    fine =
        fine && std::isfinite(next.time_s) && std::isfinite(next.speed_mm_s) && next.time_s > last.at.time_s;
    const double span_s = next.time_s - last.at.time_s;
    knots_.push_back({next, last.travel_mm + 0.5 * (last.at.speed_mm_s + next.speed_mm_s) * span_s});
  }
  if (!fine) throw std::invalid_argument("SpeedProfile: times must be > 0 and ascend, speeds be finite");
}

const SpeedProfile::Knot& SpeedProfile::knotBefore(double time_s) const {
  const auto after = std::ranges::upper_bound(knots_, time_s, {}, [](const Knot& k) { return k.at.time_s; });
  return after == knots_.begin() ? knots_.front() : *std::prev(after);
}

double SpeedProfile::acceleration_mm_s2(const Knot& from) const {
  if (&from == &knots_.back()) return 0.0;
  const SpeedPoint& next = (&from + 1)->at;
  return (next.speed_mm_s - from.at.speed_mm_s) / (next.time_s - from.at.time_s);
}

double SpeedProfile::speed_mm_s(double time_s) const {
  if (time_s <= 0.0) return knots_.front().at.speed_mm_s;
  const Knot& from = knotBefore(time_s);
  return from.at.speed_mm_s + acceleration_mm_s2(from) * (time_s - from.at.time_s);
}

double SpeedProfile::travel_mm(double time_s) const {
  if (time_s <= 0.0) return knots_.front().at.speed_mm_s * time_s;
  const Knot& from = knotBefore(time_s);
  const double since_s = time_s - from.at.time_s;
  return from.travel_mm + (from.at.speed_mm_s + 0.5 * acceleration_mm_s2(from) * since_s) * since_s;
}

}  // namespace kerfbench::twin

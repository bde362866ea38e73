// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/belt_encoder.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {
namespace {
constexpr std::uint64_t kEncoderSeed = 0x656e636f64657231ULL;
}  // namespace

BeltEncoder::BeltEncoder(TickRate rate, const EncoderDescription& encoder, double roller_radius_mm,
                         std::uint64_t seed)
    : rate_(rate),
      encoder_(encoder),
      radius_mm_(roller_radius_mm),
      random_(seed ^ kEncoderSeed, 0),
      first_(countAt(0.0)),
      count_(first_) {}

double BeltEncoder::reading_mm(double travel_mm) const {
  if (encoder_.runout_mm == 0.0) return travel_mm;
  return travel_mm + encoder_.runout_mm * (std::sin(travel_mm / radius_mm_ + encoder_.runout_phase_rad) -
                                           std::sin(encoder_.runout_phase_rad));
}

double BeltEncoder::travelAt_mm(double reading) const {
  if (encoder_.runout_mm == 0.0) return reading;
  double travel_mm = reading;
  // Newton's method needs four steps to reach 1e-13 mm from an error of a tenth of the radius.
  for (int i = 0; i < 4; ++i) {
    const double slope =
        1.0 + encoder_.runout_mm / radius_mm_ * std::cos(travel_mm / radius_mm_ + encoder_.runout_phase_rad);
    travel_mm -= (reading_mm(travel_mm) - reading) / slope;
  }
  return travel_mm;
}

double BeltEncoder::line_mm(long long line) const {
  double place = static_cast<double>(line);
  if (encoder_.jitter_counts > 0.0) {
    place += std::clamp(encoder_.jitter_counts * random_.normal(static_cast<std::uint64_t>(line)),
                        -kMaxJitter_counts, kMaxJitter_counts);
  }
  return place * encoder_.count_mm;
}

long long BeltEncoder::countAt(double reading) const {
  const auto nearest = static_cast<long long>(std::floor(reading / encoder_.count_mm));
  if (reading < line_mm(nearest)) return nearest - 1;
  return reading < line_mm(nearest + 1) ? nearest : nearest + 1;
}

void BeltEncoder::predict(const MotionForecast& roller, Tick until, std::vector<SensorEdge>& edges) {
  const long long target = countAt(reading_mm(roller.placeAfter_mm(rate_.seconds(until - roller.now))));
  while (count_ != target) {
    const bool forward = target > count_;
    // The line between the present count and the next one.
    const double goal_mm = travelAt_mm(line_mm(forward ? count_ + 1 : count_));
    count_ += forward ? 1 : -1;
    const Tick tick = roller.tickAt(goal_mm, forward, rate_, until);
    // Counts 0 1 2 3 are A B = 00 10 11 01: exactly one line changes at each boundary.
    const auto phase = static_cast<unsigned>(((count_ - first_) % 4 + 4) % 4);
    const bool a = phase == 1 || phase == 2;
    const bool b = phase >= 2;
    const bool a_changed = forward ? phase == 1 || phase == 3 : phase == 0 || phase == 2;
    edges.push_back(a_changed ? SensorEdge{tick, Signal::kEncoderA, a}
                              : SensorEdge{tick, Signal::kEncoderB, b});
  }
}

}  // namespace kerfbench::twin

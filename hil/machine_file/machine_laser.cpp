// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hil/machine_file/machine_sections.h"

namespace kerfbench::machine_file {
namespace {

constexpr std::size_t kMostPoints = 100;

std::vector<twin::PowerPoint> readPowerCurve(base::YamlReader& laser) {
  std::vector<twin::PowerPoint> curve;
  auto points = laser.list("power_curve");
  if (points.empty()) return curve;
  if (points.size() > kMostPoints) {
    laser.fault("power_curve", "has more than 100 points");
    return curve;
  }
  bool ascends = true;
  for (base::YamlReader& point : points) {
    const twin::PowerPoint next{point.number("demand", {.min = 0, .max = 1}),
                                point.number("power", {.min = 0, .max = 1})};
    ascends =
        ascends && (curve.empty() || (next.demand > curve.back().demand && next.share >= curve.back().share));
    curve.push_back(next);
  }
  if (!ascends) laser.fault("power_curve", "must ascend in demand and must not fall in power");
  if (curve.front().demand != 0 || curve.front().share != 0 || curve.back().demand != 1 ||
      curve.back().share != 1) {
    laser.fault("power_curve", "must go from {demand: 0, power: 0} to {demand: 1, power: 1}");
  }
  return curve;
}

bool bends(const std::vector<twin::PowerPoint>& curve) {
  return std::ranges::any_of(curve, [](const auto& point) { return point.share != point.demand; });
}

}  // namespace

twin::LaserDescription readLaser(base::YamlReader laser) {
  twin::LaserDescription result;
  result.full_power_w = laser.number("full_power_w", {.min = 0.1, .max = 1e5});
  result.rise_time_s = kMicro * laser.number("rise_time_us", {.min = 0, .max = 1e4});
  result.fall_time_s =
      kMicro * laser.number("fall_time_us", {.min = 0, .max = 1e4, .fallback = result.rise_time_s / kMicro});
  result.gate_delay_s = kMicro * laser.number("gate_delay_us", {.min = 0, .max = 1e4, .fallback = 0.0});
  result.demand_filter_s = kMicro * laser.number("demand_filter_us", {.min = 0, .max = 1e4, .fallback = 0.0});
  result.power_curve = readPowerCurve(laser);
  if (bends(result.power_curve) && result.demand_filter_s == 0) {
    laser.fault(
        "demand_filter_us",
        "must be > 0 with a power_curve that bends: the PWM itself is 0 or 1, only its mean meets the curve");
  }
  result.noise = kPercent * laser.number("noise_percent", {.min = 0, .max = 50, .fallback = 0.0});
  result.noise_correlation_s =
      kMilli * laser.number("noise_correlation_ms", {.min = 0.01, .max = 1e6, .fallback = 1.0});
  result.drift = kPercent * laser.number("drift_percent", {.min = -50, .max = 50, .fallback = 0.0});
  result.gate_low = laser.boolean("gate_low", false);
  result.pwm_low = laser.boolean("pwm_low", false);
  result.drift_time_s = laser.number("drift_time_s", {.min = 0.1, .max = 1e5, .fallback = 600.0});
  return result;
}

twin::PowerMonitorDescription readPowerMonitor(base::YamlReader monitor) {
  twin::PowerMonitorDescription result;
  result.quantum_j = kMilli * monitor.number("quantum_mj", {.min = 0.01, .max = 1e5, .fallback = 5.0});
  // Not below the lockstep's quantum: the controller gets its edges one quantum ahead.
  result.delay_s = kMilli * monitor.number("delay_ms", {.min = 0.5, .max = 1000, .fallback = 1.0});
  result.scale = monitor.number("scale", {.min = 0.1, .max = 10, .fallback = 1.0});
  return result;
}

}  // namespace kerfbench::machine_file

// SPDX-License-Identifier: Apache-2.0
#include "twin/laser/laser.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

constexpr double kDark = 1e-6;  // Share of full power below which there is none.

bool isPowerCurve(const std::vector<PowerPoint>& curve) {
  if (curve.empty()) return true;
  if (curve.size() < 2) return false;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    if (!(curve[i].demand < curve[i + 1].demand && curve[i].share <= curve[i + 1].share)) return false;
  }
  return curve.front().demand == 0.0 && curve.front().share == 0.0 && curve.back().demand == 1.0 &&
         curve.back().share == 1.0;
}

const LaserDescription& checked(const LaserDescription& description) {
  const std::string faults = faultsOf(description);
  if (!faults.empty()) throw std::invalid_argument(faults);
  return description;
}

double decayOver(double step_s, double time_constant_s) {
  return time_constant_s > 0.0 ? std::exp(-step_s / time_constant_s) : 0.0;
}

}  // namespace

std::string faultsOf(const LaserDescription& laser) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "laser: " : "; ") + std::string(rule);
  };
  const auto notNegative = [](double value) { return value >= 0.0 && std::isfinite(value); };
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  require(positive(laser.full_power_w), "full_power_w must be > 0");
  require(notNegative(laser.rise_time_s), "rise_time_s must be >= 0");
  require(notNegative(laser.fall_time_s), "fall_time_s must be >= 0");
  require(notNegative(laser.gate_delay_s), "gate_delay_s must be >= 0");
  require(isPowerCurve(laser.power_curve),
          "power_curve must go from (0, 0) to (1, 1), the demand ascending and the share never falling");
  require(notNegative(laser.demand_filter_s), "demand_filter_s must be >= 0");
  require(laser.noise >= 0.0 && laser.noise <= 0.3, "noise must be in [0, 0.3]");
  require(laser.noise_correlation_s >= 1e-5 && laser.noise_correlation_s <= 1e4,
          "noise_correlation_s must be in [1e-5, 1e4]");
  require(laser.drift > -1.0 && std::isfinite(laser.drift), "drift must be > -1");
  require(positive(laser.drift_time_s), "drift_time_s must be > 0");
  return faults;
}

Laser::Laser(const LaserDescription& description, std::uint64_t seed)
    : description_(checked(description)), noise_(description.noise, description.noise_correlation_s, seed) {}

double Laser::curve(double demand) const {
  const auto& points = description_.power_curve;
  if (points.empty()) return demand;
  if (demand >= 1.0) return 1.0;
  const auto above = std::ranges::upper_bound(points, demand, {}, &PowerPoint::demand);
  const PowerPoint& a = *std::prev(above);
  return a.share + (above->share - a.share) * (demand - a.demand) / (above->demand - a.demand);
}

void Laser::setLength(double step_s) {
  const double filter_s = description_.demand_filter_s;
  const double filter = decayOver(step_s, filter_s);
  decay_ = {step_s, decayOver(step_s, description_.rise_time_s), decayOver(step_s, description_.fall_time_s),
            filter, (1.0 - filter) * filter_s / step_s};
}

double Laser::smoothed(double duty) {
  if (description_.demand_filter_s == 0.0) return duty;
  const double lag = smoothed_ - duty;
  smoothed_ = duty + lag * decay_.filter;
  return duty + lag * decay_.filter_mean;
}

double Laser::warmth(double time_s) {
  if (!(time_s >= warmth_.begin_s && time_s < warmth_.end_s)) {
    constexpr double kPieces = 256.0;
    const double piece = std::floor(time_s / description_.drift_time_s * kPieces);
    const auto at = [&](double place) { return 1.0 - description_.drift * std::expm1(-place / kPieces); };
    warmth_.begin_s = piece / kPieces * description_.drift_time_s;
    warmth_.end_s = (piece + 1.0) / kPieces * description_.drift_time_s;
    warmth_.at_begin = at(piece);
    warmth_.slope_1_s = (at(piece + 1.0) - at(piece)) / (warmth_.end_s - warmth_.begin_s);
  }
  return warmth_.at_begin + warmth_.slope_1_s * (time_s - warmth_.begin_s);
}

double Laser::step(double gate, double duty, double begin_s, double step_s) {
  if (step_s != decay_.step_s) setLength(step_s);
  const double demand = smoothed(duty);
  if (gate == 0.0 && steady_w_ == 0.0) return 0.0;

  const double target_w = gate * curve(demand) * description_.full_power_w;
  const bool rises = target_w > steady_w_;
  const double decay = rises ? decay_.rise : decay_.fall;
  const double time_constant_s = rises ? description_.rise_time_s : description_.fall_time_s;
  const double lag_w = steady_w_ - target_w;
  const double energy_j = target_w * step_s + lag_w * time_constant_s * (1.0 - decay);
  steady_w_ = target_w + lag_w * decay;
  if (target_w == 0.0 && steady_w_ < kDark * description_.full_power_w) steady_w_ = 0.0;

  double scale = 1.0;
  const double end_s = begin_s + step_s;
  if (!noise_.silent()) scale = std::max(0.0, 1.0 + noise_.meanOver(begin_s, end_s));
  if (description_.drift != 0.0) scale *= warmth(0.5 * (begin_s + end_s));
  power_w_ = steady_w_ * scale;
  return energy_j * scale;
}

}  // namespace kerfbench::twin

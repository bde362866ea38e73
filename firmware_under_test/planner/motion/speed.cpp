// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/speed.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::planner {
namespace {

constexpr double kSpeedPieceRad = 0.1;

/// Highest speed at the other end of a piece that is entered, or left, with v.
double reachable(const Piece& piece, double v) {
  const double without_jerk = std::sqrt(v * v + 2.0 * piece.ramp.acceleration_mm_s2 * piece.length_mm);
  if (piece.ramp.jerk_mm_s3 <= 0.0) return without_jerk;
  return highest(v, without_jerk, [&](double top) { return piece.ramp.travelMm(v, top) - piece.length_mm; });
}

void addPhases(const Piece& piece, double v0, double v1, double s0_mm, std::vector<Phase>& phases) {
  const double peak = piece.ramp.peakMmS(piece.length_mm, v0, v1, piece.limit_mm_s);
  const double up_mm = piece.ramp.travelMm(v0, peak);
  const double level_mm = std::max(0.0, piece.length_mm - up_mm - piece.ramp.travelMm(peak, v1));
  piece.ramp.addPhases(v0, peak, s0_mm, phases);
  phases.push_back({s0_mm + up_mm, peak, 0.0, 0.0, peak > 0.0 ? level_mm / peak : 0.0});
  piece.ramp.addPhases(peak, v1, s0_mm + up_mm + level_mm, phases);
}

}  // namespace

std::vector<double> planRun(std::span<const Segment> run, const SpeedLimits& limits) {
  const Pieces cut(run, limits, kSpeedPieceRad);
  const std::vector<Piece>& pieces = cut.pieces;
  if (std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.limit_mm_s <= 0.0; }))
    return {};
  std::vector<double> node_mm_s = cut.cap_mm_s;  // Highest speeds at the borders of pieces.
  node_mm_s.front() = node_mm_s.back() = 0.0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    node_mm_s[i + 1] = std::min(node_mm_s[i + 1], reachable(pieces[i], node_mm_s[i]));
  }
  for (std::size_t i = pieces.size(); i-- > 0;) {
    node_mm_s[i] = std::min(node_mm_s[i], reachable(pieces[i], node_mm_s[i + 1]));
  }
  std::vector<Phase> phases;
  double s_mm = 0.0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    addPhases(pieces[i], node_mm_s[i], node_mm_s[i + 1], s_mm, phases);
    s_mm += pieces[i].length_mm;
  }
  const double total_s = durationOf(phases);
  constexpr double kMostPeriods = 1e7;  // Most periods: 320 MB of samples, beyond what may be planned.
  if (!(total_s < kMostPeriods * limits.period_s)) return {};
  return stationsOf(phases, std::max(1, static_cast<int>(std::ceil(total_s / limits.period_s - 1e-9))),
                    cut.length_mm);
}

AxisMove::AxisMove(double x0_mm, double v0_mm_s, double x1_mm, double speed_mm_s, double acceleration_mm_s2)
    : x0_mm_(x0_mm), v0_mm_s_(v0_mm_s), x1_mm_(x1_mm) {
  const double a = acceleration_mm_s2;
  const double stop_mm = x0_mm + v0_mm_s * std::abs(v0_mm_s) / (2.0 * a);
  const double sense = x1_mm >= stop_mm ? 1.0 : -1.0;
  peak_mm_s_ = sense * speed_mm_s;
  const auto rampMm = [&](double peak) {
    return 0.5 * (v0_mm_s + peak) * std::abs(peak - v0_mm_s) / a + 0.5 * peak * std::abs(peak) / a;
  };
  double level_mm = x1_mm - x0_mm - rampMm(peak_mm_s_);
  if (level_mm * sense < 0.0) {
    // The distance is too short for full speed: the ramps meet where their lengths add up to it.
    const double square = sense * a * (x1_mm - x0_mm) + 0.5 * v0_mm_s * v0_mm_s;
    peak_mm_s_ = sense * std::sqrt(std::max(square, 0.0));
    level_mm = 0.0;
  }
  t_s_[0] = std::abs(peak_mm_s_ - v0_mm_s) / a;
  t_s_[1] = peak_mm_s_ != 0.0 ? std::abs(level_mm / peak_mm_s_) : 0.0;
  t_s_[2] = std::abs(peak_mm_s_) / a;
}

double AxisMove::at(double t_s) const {
  if (t_s >= durationS()) return x1_mm_;
  double x = x0_mm_;
  const double up_s = std::min(t_s, t_s_[0]);
  if (t_s_[0] > 0.0) x += up_s * (v0_mm_s_ + 0.5 * (peak_mm_s_ - v0_mm_s_) * up_s / t_s_[0]);
  const double level_s = std::clamp(t_s - t_s_[0], 0.0, t_s_[1]);
  x += level_s * peak_mm_s_;
  const double down_s = std::clamp(t_s - t_s_[0] - t_s_[1], 0.0, t_s_[2]);
  if (t_s_[2] > 0.0) x += down_s * peak_mm_s_ * (1.0 - 0.5 * down_s / t_s_[2]);
  return x;
}

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/speed.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::planner {
namespace {

/// On an arc the acceleration is shared between the normal and the tangent: 0.8² + 0.6² = 1.
constexpr double kNormalShare = 0.8;
constexpr double kTangentShare = 0.6;
constexpr double kPieceRad = 0.1;

/// A stretch of path under one speed limit.
struct Piece {
  double length_mm{};
  double limit_mm_s{};
  double acceleration_mm_s2{};
};

/// Motion under constant acceleration.
struct Phase {
  double s_mm{}, v_mm_s{}, a_mm_s2{}, duration_s{};
};

void addPieces(const Segment& segment, const SpeedLimits& limits, std::vector<Piece>& pieces) {
  const double length_mm = segment.lengthMm();
  if (!segment.isArc()) {
    const double axes = limits.axes_mm_s(segment.tangentAt(0.0));
    pieces.push_back({length_mm, std::min(limits.path_mm_s, axes), limits.acceleration_mm_s2});
    return;
  }
  const int count = static_cast<int>(std::ceil(std::abs(segment.sweep_rad) / kPieceRad));
  const double centripetal = std::sqrt(kNormalShare * limits.acceleration_mm_s2 * segment.radiusMm());
  for (int i = 0; i < count; ++i) {
    double limit = std::min(limits.path_mm_s, centripetal);
    for (const double u : {0.0, 0.5, 1.0}) {
      limit = std::min(limit, limits.axes_mm_s(segment.tangentAt(length_mm * (i + u) / count)));
    }
    pieces.push_back({length_mm / count, limit, kTangentShare * limits.acceleration_mm_s2});
  }
}

void addPhases(const Piece& piece, double v0, double v1, double s0_mm, std::vector<Phase>& phases) {
  const double a = piece.acceleration_mm_s2;
  const double peak = std::max(
      {v0, v1, std::min(piece.limit_mm_s, std::sqrt(a * piece.length_mm + 0.5 * (v0 * v0 + v1 * v1)))});
  const double up_mm = (peak * peak - v0 * v0) / (2.0 * a);
  const double down_mm = (peak * peak - v1 * v1) / (2.0 * a);
  const double level_mm = std::max(0.0, piece.length_mm - up_mm - down_mm);
  phases.push_back({s0_mm, v0, a, (peak - v0) / a});
  phases.push_back({s0_mm + up_mm, peak, 0.0, peak > 0.0 ? level_mm / peak : 0.0});
  phases.push_back({s0_mm + up_mm + level_mm, peak, -a, (peak - v1) / a});
}

}  // namespace

std::vector<double> planRun(std::span<const Segment> run, const SpeedLimits& limits) {
  std::vector<Piece> pieces;
  std::vector<double> node_mm_s{0.0};  // the highest speed at each border of pieces
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i > 0) {
      const double turn = turnRad(run[i - 1], run[i]);
      // The turn happens within one period: v * turn / T is its acceleration.
      node_mm_s.back() = turn > 1e-9 ? limits.acceleration_mm_s2 * limits.period_s / turn : limits.path_mm_s;
    }
    const std::size_t before = pieces.size();
    addPieces(run[i], limits, pieces);
    node_mm_s.resize(node_mm_s.size() + pieces.size() - before, limits.path_mm_s);
  }
  node_mm_s.back() = 0.0;
  double total_mm = 0.0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].limit_mm_s <= 0.0) return {};
    node_mm_s[i] = std::min(node_mm_s[i], pieces[i].limit_mm_s);
    node_mm_s[i + 1] = std::min(node_mm_s[i + 1], pieces[i].limit_mm_s);
    total_mm += pieces[i].length_mm;
  }
  const auto reachable = [](double v, const Piece& piece) {
    return std::sqrt(v * v + 2.0 * piece.acceleration_mm_s2 * piece.length_mm);
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    node_mm_s[i + 1] = std::min(node_mm_s[i + 1], reachable(node_mm_s[i], pieces[i]));
  }
  for (std::size_t i = pieces.size(); i-- > 0;) {
    node_mm_s[i] = std::min(node_mm_s[i], reachable(node_mm_s[i + 1], pieces[i]));
  }
  std::vector<Phase> phases;
  double s_mm = 0.0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    addPhases(pieces[i], node_mm_s[i], node_mm_s[i + 1], s_mm, phases);
    s_mm += pieces[i].length_mm;
  }
  double total_s = 0.0;
  for (const Phase& phase : phases) total_s += phase.duration_s;
  constexpr double kMostPeriods = 1e7;  // 320 MB of samples, beyond what may be planned
  if (!(total_s < kMostPeriods * limits.period_s)) return {};
  const int periods = std::max(1, static_cast<int>(std::ceil(total_s / limits.period_s - 1e-9)));
  std::vector<double> stations{0.0};
  std::size_t at = 0;
  double begun_s = 0.0;
  for (int k = 1; k < periods; ++k) {
    const double t_s = total_s * k / periods;
    while (at + 1 < phases.size() && t_s > begun_s + phases[at].duration_s)
      begun_s += phases[at++].duration_s;
    const Phase& phase = phases[at];
    const double dt_s = t_s - begun_s;
    const double station = phase.s_mm + dt_s * (phase.v_mm_s + 0.5 * phase.a_mm_s2 * dt_s);
    stations.push_back(std::clamp(station, stations.back(), total_mm));
  }
  stations.push_back(total_mm);
  return stations;
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
    // Too short for full speed: turn over where the way up and the way down add up to the distance.
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

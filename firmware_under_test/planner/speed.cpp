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
/// Of the jerk on a line, and of that of a joint, which is across the path: 0.8² + 0.6² = 1.
constexpr double kLineJerkShare = 0.8;
constexpr double kJointJerkShare = 0.6;
/// Of the jerk on an arc: 0.5 + 0.3 along the path and 0.6 across it make 1.
constexpr double kBendJerkShare = 0.5;
constexpr double kPathJerkShare = 0.3;
constexpr double kCrossJerkShare = 0.6;

/// A stretch of path under one speed limit.
struct Piece {
  double length_mm{};
  double limit_mm_s{};
  double acceleration_mm_s2{};
  double jerk_mm_s3{};  ///< Along the path; 0: no limit.

  /// Time in which the speed changes by so much, from and to no acceleration if the jerk is limited.
  [[nodiscard]] double rampS(double change_mm_s) const {
    const double a = acceleration_mm_s2;
    if (jerk_mm_s3 <= 0.0) return change_mm_s / a;
    if (change_mm_s * jerk_mm_s3 >= a * a) return change_mm_s / a + a / jerk_mm_s3;
    return 2.0 * std::sqrt(change_mm_s / jerk_mm_s3);
  }
  /// Way of that: both kinds of ramp are symmetrical.
  [[nodiscard]] double rampMm(double v0, double v1) const {
    if (jerk_mm_s3 <= 0.0) return std::abs(v1 * v1 - v0 * v0) / (2.0 * acceleration_mm_s2);
    return 0.5 * (v0 + v1) * rampS(std::abs(v1 - v0));
  }
  /// Highest speed of which holds(speed), true up to somewhere in low … high.
  template <typename Holds>
  static double highest(double low, double high, const Holds& holds) {
    if (holds(high)) return high;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    return low;
  }
  /// Highest speed at one end if it is v at the other.
  [[nodiscard]] double reachable(double v) const {
    const double without_jerk = std::sqrt(v * v + 2.0 * acceleration_mm_s2 * length_mm);
    if (jerk_mm_s3 <= 0.0) return without_jerk;
    return highest(v, without_jerk, [&](double top) { return rampMm(v, top) <= length_mm; });
  }
};

/// Motion under constant jerk.
struct Phase {
  double s_mm{}, v_mm_s{}, a_mm_s2{}, j_mm_s3{}, duration_s{};

  [[nodiscard]] double wayMm(double t_s) const {
    return t_s * (v_mm_s + t_s * (0.5 * a_mm_s2 + t_s * j_mm_s3 / 6.0));
  }
};

void addPieces(const Segment& segment, const SpeedLimits& limits, std::vector<Piece>& pieces) {
  const double length_mm = segment.lengthMm();
  const double jerk = limits.jerk_mm_s3;
  if (!segment.isArc()) {
    const double axes = limits.axes_mm_s(segment.tangentAt(0.0));
    pieces.push_back(
        {length_mm, std::min(limits.path_mm_s, axes), limits.acceleration_mm_s2, kLineJerkShare * jerk});
    return;
  }
  const int count = static_cast<int>(std::ceil(std::abs(segment.sweep_rad) / kPieceRad));
  const double radius_mm = segment.radiusMm();
  double bend = std::sqrt(kNormalShare * limits.acceleration_mm_s2 * radius_mm);
  if (jerk > 0.0) bend = std::min(bend, std::cbrt(kBendJerkShare * jerk * radius_mm * radius_mm));
  for (int i = 0; i < count; ++i) {
    double limit = std::min(limits.path_mm_s, bend);
    for (const double u : {0.0, 0.5, 1.0}) {
      limit = std::min(limit, limits.axes_mm_s(segment.tangentAt(length_mm * (i + u) / count)));
    }
    double along = kTangentShare * limits.acceleration_mm_s2;
    if (jerk > 0.0 && limit > 0.0)
      along = std::min(along, kCrossJerkShare * jerk * radius_mm / (3.0 * limit));
    pieces.push_back({length_mm / count, limit, along, kPathJerkShare * jerk});
  }
}

double signedCurvature(const Segment& segment) {
  return segment.isArc() ? std::copysign(1.0 / segment.radiusMm(), segment.sweep_rad) : 0.0;
}

/// Highest speed from one segment to the next.
double jointSpeed(const Segment& before, const Segment& after, const SpeedLimits& limits) {
  const double turn = turnRad(before, after);
  // The turn happens within one period: v * turn / T is its acceleration.
  double speed = turn > 1e-9 ? limits.acceleration_mm_s2 * limits.period_s / turn : limits.path_mm_s;
  if (limits.jerk_mm_s3 <= 0.0) return speed;
  const double per_period = kJointJerkShare * limits.jerk_mm_s3 * limits.period_s;
  if (turn > 1e-9) speed = std::min(speed, per_period * limits.period_s / turn);
  const double change = std::abs(signedCurvature(after) - signedCurvature(before));
  if (change > 1e-9) speed = std::min(speed, std::sqrt(per_period / change));
  return speed;
}

/// From v0 to v1, beginning at s0_mm.
void addRamp(const Piece& piece, double v0, double v1, double s0_mm, std::vector<Phase>& phases) {
  const double sense = v1 >= v0 ? 1.0 : -1.0;
  const double change = std::abs(v1 - v0);
  const double a = piece.acceleration_mm_s2;
  const double j = piece.jerk_mm_s3;
  if (j <= 0.0) {
    phases.push_back({s0_mm, v0, sense * a, 0.0, change / a});
    return;
  }
  const double top_a = std::min(a, std::sqrt(change * j));
  const double bow_s = top_a / j;
  const double level_s = top_a > 0.0 ? std::max(0.0, change / top_a - bow_s) : 0.0;
  double s_mm = s0_mm;
  double v = v0;
  const auto add = [&](double from_a, double jerk, double t) {
    phases.push_back({s_mm, v, from_a, jerk, t});
    s_mm += phases.back().wayMm(t);
    v += t * (from_a + 0.5 * t * jerk);
  };
  add(0.0, sense * j, bow_s);
  add(sense * top_a, 0.0, level_s);
  add(sense * top_a, -sense * j, bow_s);
}

void addPhases(const Piece& piece, double v0, double v1, double s0_mm, std::vector<Phase>& phases) {
  const double a = piece.acceleration_mm_s2;
  const double least = std::max(v0, v1);
  double peak =
      std::max(least, std::min(piece.limit_mm_s, std::sqrt(a * piece.length_mm + 0.5 * (v0 * v0 + v1 * v1))));
  if (piece.jerk_mm_s3 > 0.0) {
    peak = Piece::highest(least, peak, [&](double top) {
      return piece.rampMm(v0, top) + piece.rampMm(top, v1) <= piece.length_mm;
    });
  }
  const double up_mm = piece.rampMm(v0, peak);
  const double level_mm = std::max(0.0, piece.length_mm - up_mm - piece.rampMm(peak, v1));
  addRamp(piece, v0, peak, s0_mm, phases);
  phases.push_back({s0_mm + up_mm, peak, 0.0, 0.0, peak > 0.0 ? level_mm / peak : 0.0});
  addRamp(piece, peak, v1, s0_mm + up_mm + level_mm, phases);
}

}  // namespace

std::vector<double> planRun(std::span<const Segment> run, const SpeedLimits& limits) {
  std::vector<Piece> pieces;
  std::vector<double> node_mm_s{0.0};  // the highest speed at each border of pieces
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i > 0) {
      node_mm_s.back() = jointSpeed(run[i - 1], run[i], limits);
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
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    node_mm_s[i + 1] = std::min(node_mm_s[i + 1], pieces[i].reachable(node_mm_s[i]));
  }
  for (std::size_t i = pieces.size(); i-- > 0;) {
    node_mm_s[i] = std::min(node_mm_s[i], pieces[i].reachable(node_mm_s[i + 1]));
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
    stations.push_back(std::clamp(phase.s_mm + phase.wayMm(dt_s), stations.back(), total_mm));
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

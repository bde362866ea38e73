// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kCentripetalShare = 0.8;
/// Angle of an interval: small enough for the limits of a bend, and for a peak of speed on a short line.
constexpr double kIntervalRad = 0.08;
constexpr double kIntervalMm = 0.4;
constexpr int kMostOfALine = 24;

int intervalsOf(const Segment& segment) {
  const double length_mm = segment.lengthMm();
  const int by_length = std::clamp(static_cast<int>(std::ceil(length_mm / kIntervalMm)), 2, kMostOfALine);
  return std::max(by_length, static_cast<int>(std::ceil(std::abs(segment.sweep_rad) / kIntervalRad)));
}

}  // namespace

double FlowLimits::least(bool jump) const {
  return std::min(jump ? jump_acceleration_mm_s2 : acceleration_mm_s2, box_mm_s2.minCoeff());
}

SpeedProfile::SpeedProfile(std::span<const Segment> run, const FlowLimits& limits)
    : acceleration_mm_s2_(run.front().jump ? limits.jump_acceleration_mm_s2 : limits.acceleration_mm_s2),
      box_mm_s2_(limits.box_mm_s2),
      cap_{kInfinite} {
  const double path_mm_s = run.front().jump ? limits.jump_mm_s : limits.mark_mm_s;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i > 0) {
      const double turn = turnRad(run[i - 1], run[i]);
      cap_.back() = std::min(
          cap_.back(), turnSpeed(turn, limits.least(run.front().jump), limits.period_s, limits.corners));
    }
    add(run[i], path_mm_s, limits);
  }
}

void SpeedProfile::add(const Segment& segment, double path_mm_s, const FlowLimits& limits) {
  const double total_mm = segment.lengthMm();
  const int count = intervalsOf(segment);
  for (int i = 0; i < count; ++i) {
    Interval interval;
    interval.length_mm = total_mm / count;
    interval.curvature_1_mm = segment.isArc() ? 1.0 / segment.radiusMm() : 0.0;
    double cap = std::min(path_mm_s, segment.most_mm_s);
    for (const double u : {0.0, 0.5, 1.0}) {
      const Vector2d tangent = segment.tangentAt(total_mm * (i + u) / count);
      interval.along = interval.along.cwiseMax(tangent.cwiseAbs());
      interval.across = interval.across.cwiseMax(Vector2d(std::abs(tangent.y()), std::abs(tangent.x())));
      cap = std::min(cap, limits.axes_mm_s(tangent));
    }
    if (interval.curvature_1_mm > 0.0) {
      const Vector2d bend = interval.across * interval.curvature_1_mm;
      const double least =
          std::min({box_mm_s2_.x() / std::max(bend.x(), 1e-300), box_mm_s2_.y() / std::max(bend.y(), 1e-300),
                    acceleration_mm_s2_ / interval.curvature_1_mm});
      cap = std::min(cap, std::sqrt(kCentripetalShare * least));
    }
    cap_.back() = std::min(cap_.back(), cap);
    cap_.push_back(cap);
    length_mm_ += interval.length_mm;
    intervals_.push_back(interval);
  }
}

double SpeedProfile::faster(const Interval& interval, double v_mm_s) const {
  // Highest w' of w' - w <= 2 length h(w'), w = v², h the path acceleration that is left at w'.
  const double w = v_mm_s * v_mm_s;
  const double twice = 2.0 * interval.length_mm;
  double most = kInfinite;
  for (int i = 0; i < 2; ++i) {
    const double bend = interval.curvature_1_mm * interval.across[i];
    const double denominator = interval.along[i] + twice * bend;
    if (denominator > 0.0) {
      most = std::min(most, (twice * box_mm_s2_[i] + interval.along[i] * w) / denominator);
    }
  }
  const double reach = twice * acceleration_mm_s2_;
  const double q = twice * twice * interval.curvature_1_mm * interval.curvature_1_mm;
  most = std::min(most, (w + std::sqrt(std::max(0.0, (1.0 + q) * reach * reach - q * w * w))) / (1.0 + q));
  return std::sqrt(std::max(most, 0.0));
}

double SpeedProfile::slower(const Interval& interval, double v_mm_s) const {
  const double w = v_mm_s * v_mm_s;
  const double bend = interval.curvature_1_mm * w;
  double left = std::sqrt(std::max(0.0, acceleration_mm_s2_ * acceleration_mm_s2_ - bend * bend));
  for (int i = 0; i < 2; ++i) {
    if (interval.along[i] > 0.0) {
      left = std::min(left, std::max(0.0, box_mm_s2_[i] - bend * interval.across[i]) / interval.along[i]);
    }
  }
  return std::sqrt(std::max(0.0, w - 2.0 * interval.length_mm * left));
}

SpeedProfile::Speeds SpeedProfile::fastestFrom(double v_mm_s) const {
  Speeds speeds(cap_.size());
  speeds.front() = std::min(v_mm_s, cap_.front());
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    speeds[i + 1] = std::min(cap_[i + 1], faster(intervals_[i], speeds[i]));
  }
  return speeds;
}

SpeedProfile::Speeds SpeedProfile::fastestTo(double v_mm_s) const {
  Speeds speeds(cap_.size());
  speeds.back() = std::min(v_mm_s, cap_.back());
  for (std::size_t i = intervals_.size(); i-- > 0;) {
    speeds[i] = std::min(cap_[i], faster(intervals_[i], speeds[i + 1]));
  }
  return speeds;
}

SpeedProfile::Speeds SpeedProfile::slowestFrom(double v_mm_s) const {
  Speeds speeds(cap_.size());
  speeds.front() = v_mm_s;
  for (std::size_t i = 0; i < intervals_.size(); ++i) speeds[i + 1] = slower(intervals_[i], speeds[i]);
  return speeds;
}

SpeedProfile::Speeds SpeedProfile::slowestTo(double v_mm_s) const {
  Speeds speeds(cap_.size());
  speeds.back() = v_mm_s;
  for (std::size_t i = intervals_.size(); i-- > 0;) speeds[i] = slower(intervals_[i], speeds[i + 1]);
  return speeds;
}

double SpeedProfile::durationS(const Speeds& speeds) const {
  double total_s = 0.0;
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    total_s += 2.0 * intervals_[i].length_mm / (speeds[i] + speeds[i + 1]);
  }
  return total_s;
}

SpeedProfile::Speeds SpeedProfile::realise(const Speeds& slow, const Speeds& fast, double total_s) const {
  const auto cutAt = [&](double top_mm_s) {
    Speeds speeds(fast.size());
    for (std::size_t i = 0; i < fast.size(); ++i) {
      speeds[i] = std::min(fast[i], std::max(slow[i], top_mm_s));
    }
    return speeds;
  };
  double low = 0.0;
  double high = *std::max_element(fast.begin(), fast.end());
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (durationS(cutAt(middle)) > total_s ? low : high) = middle;
  }
  return cutAt(high);
}

std::vector<double> SpeedProfile::stations(const Speeds& slow, const Speeds& fast, int periods,
                                           double period_s) const {
  return stations(realise(slow, fast, periods * period_s), periods);
}

std::vector<double> SpeedProfile::stations(const Speeds& speeds, int periods) const {
  const double total_s = durationS(speeds);
  std::vector<double> stations{0.0};
  std::size_t at = 0;
  double begun_s = 0.0;
  double begun_mm = 0.0;
  const auto lasts = [&] { return 2.0 * intervals_[at].length_mm / (speeds[at] + speeds[at + 1]); };
  for (int k = 1; k < periods; ++k) {
    const double t_s = total_s * k / periods;
    while (at + 1 < intervals_.size() && t_s > begun_s + lasts()) {
      begun_s += lasts();
      begun_mm += intervals_[at++].length_mm;
    }
    const double dt_s = t_s - begun_s;
    const double gain = (speeds[at + 1] - speeds[at]) / lasts();
    const double station = begun_mm + dt_s * (speeds[at] + 0.5 * gain * dt_s);
    stations.push_back(std::clamp(station, stations.back(), length_mm_));
  }
  stations.push_back(length_mm_);
  return stations;
}

}  // namespace kerfbench::planner

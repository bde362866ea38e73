// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/jerk_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::planner {
namespace {

/// Angle of an arc's piece, larger than in planRun(): an S-curve must find room within a piece.
constexpr double kJerkPieceRad = 0.4;

/// Highest speed at the other end of a piece that is entered, or left, with v.
double faster(const Piece& piece, double v) {
  const double top = std::sqrt(v * v + 2.0 * piece.ramp.acceleration_mm_s2 * piece.length_mm);
  return highest(v, top, [&](double w) { return piece.ramp.mostTravelMm(v, w) - piece.length_mm; });
}

/// Lowest speed at the other end of a piece that is entered, or left, with v.
double slower(const Piece& piece, double v) {
  const auto excess = [&](double drop) { return piece.ramp.mostTravelMm(v, v - drop) - piece.length_mm; };
  return v - highest(0.0, v, excess);
}

double levelS(double length_mm, double v_mm_s) {
  if (length_mm <= 0.0) return 0.0;
  return v_mm_s > 0.0 ? length_mm / v_mm_s : kInfinite;
}

}  // namespace

SpeedLimits speedLimitsOf(const FlowLimits& limits, bool jump) {
  return {jump ? limits.jump_mm_s : limits.mark_mm_s,
          limits.least(jump),
          limits.period_s,
          limits.axes_mm_s,
          limits.jerk_mm_s3,
          limits.corners};
}

JerkProfile::JerkProfile(std::span<const Segment> run, const FlowLimits& limits)
    : path_(run, speedLimitsOf(limits, run.front().jump), kJerkPieceRad) {}

JerkProfile::Speeds JerkProfile::fastestFrom(double v_mm_s) const {
  Speeds speeds{std::min(v_mm_s, firstCap())};
  for (std::size_t i = 0; i < path_.pieces.size(); ++i)
    speeds.push_back(std::min(path_.cap_mm_s[i + 1], faster(path_.pieces[i], speeds.back())));
  return speeds;
}

JerkProfile::Speeds JerkProfile::fastestTo(double v_mm_s) const {
  Speeds speeds(path_.cap_mm_s.size());
  speeds.back() = std::min(v_mm_s, lastCap());
  for (std::size_t i = path_.pieces.size(); i-- > 0;)
    speeds[i] = std::min(path_.cap_mm_s[i], faster(path_.pieces[i], speeds[i + 1]));
  return speeds;
}

JerkProfile::Speeds JerkProfile::slowestFrom(double v_mm_s) const {
  Speeds speeds{v_mm_s};
  for (const Piece& piece : path_.pieces) speeds.push_back(slower(piece, speeds.back()));
  return speeds;
}

JerkProfile::Speeds JerkProfile::slowestTo(double v_mm_s) const {
  Speeds speeds(path_.cap_mm_s.size());
  speeds.back() = v_mm_s;
  for (std::size_t i = path_.pieces.size(); i-- > 0;) speeds[i] = slower(path_.pieces[i], speeds[i + 1]);
  return speeds;
}

JerkProfile::Course JerkProfile::courseOf(const Piece& piece, double v0_mm_s, double v1_mm_s,
                                          double cut_mm_s) {
  const double low = std::min(v0_mm_s, v1_mm_s);
  const double high = std::max(v0_mm_s, v1_mm_s);
  const auto left = [&](double middle) {
    return std::max(
        0.0, piece.length_mm - piece.ramp.travelMm(v0_mm_s, middle) - piece.ramp.travelMm(middle, v1_mm_s));
  };
  if (cut_mm_s >= high) {
    const double peak =
        piece.ramp.peakMmS(piece.length_mm, v0_mm_s, v1_mm_s, std::min(cut_mm_s, piece.limit_mm_s));
    return {0.0, peak, left(peak)};
  }
  if (cut_mm_s <= low) {
    const double drop = highest(0.0, low - cut_mm_s, [&](double d) {
      return piece.ramp.mostTravelMm(v0_mm_s, low - d) + piece.ramp.mostTravelMm(low - d, v1_mm_s) -
             piece.length_mm;
    });
    return {0.0, low - drop, left(low - drop)};
  }
  // The motion is one ramp; the more of the remaining length is at the faster end, the higher the cut.
  const double fast_mm = (cut_mm_s - low) / (high - low) * left(v1_mm_s);
  const double slow_mm = left(v1_mm_s) - fast_mm;
  return v0_mm_s < v1_mm_s ? Course{slow_mm, v1_mm_s, fast_mm} : Course{fast_mm, v1_mm_s, slow_mm};
}

double JerkProfile::durationS(const Speeds& speeds, double cut_mm_s) const {
  double total_s = 0.0;
  for (std::size_t i = 0; i < path_.pieces.size(); ++i) {
    const Piece& piece = path_.pieces[i];
    const Course course = courseOf(piece, speeds[i], speeds[i + 1], cut_mm_s);
    total_s += levelS(course.at_v0_mm, speeds[i]) + piece.ramp.durationS(speeds[i], course.middle_mm_s) +
               levelS(course.at_middle_mm, course.middle_mm_s) +
               piece.ramp.durationS(course.middle_mm_s, speeds[i + 1]);
  }
  return total_s;
}

JerkProfile::Speeds JerkProfile::cutOff(const Speeds& slow, const Speeds& fast, double cut_mm_s) {
  Speeds speeds(fast.size());
  for (std::size_t i = 0; i < fast.size(); ++i) speeds[i] = std::min(fast[i], std::max(slow[i], cut_mm_s));
  return speeds;
}

double JerkProfile::shortestS(const Speeds& fast) const { return durationS(fast, kInfinite); }

bool JerkProfile::canTake(const Speeds& slow, double total_s) const {
  return durationS(slow, 0.0) >= total_s;
}

std::vector<double> JerkProfile::stations(const Speeds& slow, const Speeds& fast, int periods,
                                          double period_s) const {
  const double total_s = periods * period_s;
  double low = 0.0;
  double high = 0.0;
  for (const Piece& piece : path_.pieces) high = std::max(high, piece.limit_mm_s);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (durationS(cutOff(slow, fast, middle), middle) > total_s ? low : high) = middle;
  }
  const Speeds speeds = cutOff(slow, fast, high);
  std::vector<Phase> phases;
  double s_mm = 0.0;
  const auto level = [&](double length_mm, double v_mm_s) {
    if (length_mm <= 0.0) return;
    phases.push_back({s_mm, v_mm_s, 0.0, 0.0, length_mm / v_mm_s});
    s_mm += length_mm;
  };
  const auto ramp = [&](const Ramp& how, double v0, double v1) {
    how.addPhases(v0, v1, s_mm, phases);
    s_mm += how.travelMm(v0, v1);
  };
  for (std::size_t i = 0; i < path_.pieces.size(); ++i) {
    const Piece& piece = path_.pieces[i];
    const Course course = courseOf(piece, speeds[i], speeds[i + 1], high);
    level(course.at_v0_mm, speeds[i]);
    ramp(piece.ramp, speeds[i], course.middle_mm_s);
    level(course.at_middle_mm, course.middle_mm_s);
    ramp(piece.ramp, course.middle_mm_s, speeds[i + 1]);
  }
  return stationsOf(phases, periods, path_.length_mm);
}

}  // namespace kerfbench::planner

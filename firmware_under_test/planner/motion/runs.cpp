// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "firmware_under_test/planner/geometry/jump_curve.h"
#include "firmware_under_test/planner/motion/jerk_profile.h"

namespace kerfbench::planner {
namespace {

constexpr double kNoLengthMm = 1e-9;
/// Shares of the radius that are tried, a half-octave apart.
constexpr double kRadiusShares[] = {1.0, 0.7071, 0.5, 0.3536, 0.25, 0.1768, 0.125};
/// Turn from which on a path goes back on itself: the beam rests there.
constexpr double kTurnsBackRad = 3.14;

/// Index behind the run that begins at `first`. Runs end where the laser changes or the path turns back.
std::size_t runEnd(const std::vector<Segment>& path, std::size_t first) {
  std::size_t i = first + 1;
  while (i < path.size() && !path[first].jump && !path[i].jump && path[i].z == path[first].z &&
         turnRad(path[i - 1], path[i]) < kTurnsBackRad) {
    ++i;
  }
  return i;
}

/// Ramp of a line at the acceleration that no direction forbids.
Ramp rampOf(bool jump, const FlowLimits& limits) { return {limits.least(jump), limits.jerk_mm_s3}; }

/// Time of a line with speed v0 at both ends and more in between.
double travelTimeS(double length_mm, double v0, const FlowLimits& limits) {
  const Ramp ramp = rampOf(true, limits);
  const double peak = ramp.peakMmS(length_mm, v0, v0, limits.jump_mm_s);
  if (peak <= 0.0) return 0.0;
  return 2.0 * ramp.durationS(v0, peak) + std::max(0.0, length_mm - 2.0 * ramp.travelMm(v0, peak)) / peak;
}

/// Time that marks lose by ending, or beginning, at v instead of at full speed.
double rampLossS(double v, const FlowLimits& limits) {
  if (v >= limits.mark_mm_s) return 0.0;
  return rampOf(false, limits).durationS(v, limits.mark_mm_s) * (limits.mark_mm_s - v) / limits.mark_mm_s;
}

/// Estimated time of one jump: arcs at the speed that their bend allows, the line faster.
double costS(const std::vector<Segment>& path, const FlowLimits& limits) {
  const SpeedLimits each = speedLimitsOf(limits, true);
  double v = std::min(limits.mark_mm_s, limits.jump_mm_s);
  for (const Segment& segment : path) {
    if (!segment.isArc()) continue;
    const double radius_mm = segment.radiusMm();
    v = std::min({v, bendSpeed(radius_mm, each), curvatureStepSpeed(1.0 / radius_mm, each)});
  }
  double total_s = rampLossS(v, limits);
  for (const Segment& segment : path)
    total_s += segment.isArc() ? segment.lengthMm() / v : travelTimeS(segment.lengthMm(), v, limits);
  return total_s;
}

/// True if an arc leaves the field. Arcs swing out of the rectangle that holds both ends.
bool leavesField(const std::vector<Segment>& path, const FlowLimits& limits) {
  for (const Segment& segment : path) {
    if (!segment.isArc()) continue;
    constexpr int kParts = 32;
    for (int i = 0; i <= kParts; ++i) {
      const Eigen::Vector2d p = segment.at(segment.lengthMm() * i / kParts);
      if ((p.array() < limits.low_mm.array()).any() || (p.array() > limits.high_mm.array()).any())
        return true;
    }
  }
  return false;
}

/// Curve for a jump, or why there is none.
struct Choice {
  std::vector<Segment> curve;
  std::optional<JumpsTaken::Why> why_not;
};

Choice bestCurve(const JumpEnds& ends, const JumpWish& wish, const FlowLimits& limits) {
  Choice best{{}, wish.soonest ? JumpsTaken::Why::kSooner : JumpsTaken::Why::kNoCurve};
  double least_s = kInfinite;
  if (wish.soonest)
    least_s = rampLossS(0.0, limits) + travelTimeS((ends.to_mm - ends.from_mm).norm(), 0.0, limits);
  for (const double share : kRadiusShares) {
    const auto curve = smoothJump(ends, share * wish.radius_mm);
    if (!curve) continue;
    if (leavesField(*curve, limits)) {
      if (best.why_not) best.why_not = JumpsTaken::Why::kField;
      continue;
    }
    const double cost_s = costS(*curve, limits);
    if (cost_s >= least_s) continue;
    least_s = cost_s;
    best = {*curve, std::nullopt};
  }
  return best;
}

Segment straightJump(const Segment& first, const Segment& last) {
  Segment jump = first;
  jump.end_mm = last.end_mm;
  return jump;
}

}  // namespace

std::vector<Run> straightRuns(const std::vector<Segment>& path) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < path.size();) {
    const std::size_t end = runEnd(path, i);
    Run run;
    run.segments.assign(path.begin() + static_cast<std::ptrdiff_t>(i),
                        path.begin() + static_cast<std::ptrdiff_t>(end));
    run.rests = true;
    run.begins_block = i == 0 || (path[i].jump && !path[i - 1].jump);
    runs.push_back(std::move(run));
    i = end;
  }
  return runs;
}

std::vector<Run> smoothRuns(const std::vector<Segment>& path, const JumpWish& wish, const FlowLimits& limits,
                            JumpsTaken& taken) {
  std::vector<Run> runs;
  std::size_t jumps = 0;
  bool after_stop = true;  // True for the first run, and for a mark after a straight jump.
  for (std::size_t i = 0; i < path.size();) {
    std::size_t end = runEnd(path, i);
    Run run;
    if (!path[i].jump) {
      run.segments.assign(path.begin() + static_cast<std::ptrdiff_t>(i),
                          path.begin() + static_cast<std::ptrdiff_t>(end));
      run.begins_block =
          runs.empty() || (path[i - 1].jump && !runs.back().segments.front().jump && after_stop);
      run.rests = after_stop || (!path[i - 1].jump && turnRad(path[i - 1], path[i]) >= kTurnsBackRad);
      after_stop = false;
      runs.push_back(std::move(run));
      i = end;
      continue;
    }
    while (path[end].jump) ++end;  // The path ends with a mark.
    const Segment& before = path[i - 1];
    const Segment& after = path[end];
    const JumpEnds ends{before.end_mm, before.tangentAt(before.lengthMm()), after.start_mm,
                        after.tangentAt(0.0)};
    const bool held = jumps < wish.stops.size() && wish.stops[jumps];
    ++jumps;
    Choice choice = held ? Choice{{}, JumpsTaken::Why::kWaits} : bestCurve(ends, wish, limits);
    if (!choice.why_not) {
      run.segments = std::move(choice.curve);
      ++taken.smooth;
    } else {
      taken.straight.push_back({after.entity, after.line, *choice.why_not});
      after_stop = run.rests = run.begins_block = true;
      const Segment jump = straightJump(path[i], path[end - 1]);
      if (jump.lengthMm() > kNoLengthMm) run.segments = {jump};
    }
    if (!run.segments.empty()) runs.push_back(std::move(run));
    i = end;
  }
  return runs;
}

}  // namespace kerfbench::planner

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
constexpr double kRadiusShares[] = {1.0, 0.5, 0.25, 0.125};

/// Index behind the run that begins at `first`. Runs end where the laser or the direction changes.
std::size_t runEnd(const std::vector<Segment>& path, std::size_t first) {
  std::size_t i = first + 1;
  while (i < path.size() && !path[first].jump && !path[i].jump && path[i].z == path[first].z &&
         turnRad(path[i - 1], path[i]) <= kTangentRad) {
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
      const double y = segment.at(segment.lengthMm() * i / kParts).y();
      if (y < limits.low_y_mm || y > limits.high_y_mm) return true;
    }
  }
  return false;
}

/// Best curve for a jump; nullopt: straight, with stops.
std::optional<std::vector<Segment>> bestCurve(const JumpEnds& ends, double radius_mm,
                                              const FlowLimits& limits) {
  const double straight_mm = (ends.to_mm - ends.from_mm).norm();
  double least_s = rampLossS(0.0, limits) + travelTimeS(straight_mm, 0.0, limits);
  std::optional<std::vector<Segment>> best;
  for (const double share : kRadiusShares) {
    const auto curve = smoothJump(ends, share * radius_mm);
    if (!curve || leavesField(*curve, limits)) continue;
    const double cost_s = costS(*curve, limits);
    if (cost_s >= least_s) continue;
    least_s = cost_s;
    best = *curve;
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

std::vector<Run> smoothRuns(const std::vector<Segment>& path, double radius_mm, const FlowLimits& limits,
                            const std::vector<bool>& stops) {
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
      run.rests = after_stop || (!path[i - 1].jump && turnRad(path[i - 1], path[i]) > kTangentRad);
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
    const bool held = jumps < stops.size() && stops[jumps];
    ++jumps;
    const auto curve = held ? std::nullopt : bestCurve(ends, radius_mm, limits);
    if (curve) {
      run.segments = *curve;
    } else {
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

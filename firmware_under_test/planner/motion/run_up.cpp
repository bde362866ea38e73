// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/run_up.h"

#include <utility>

#include "firmware_under_test/planner/motion/jerk_profile.h"

namespace kerfbench::planner {
namespace {

bool isJump(const Run& run) { return run.segments.front().jump; }

Run straight(const Segment& like, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) {
  Segment segment;
  segment.jump = true;
  segment.entity = like.entity;
  segment.line = like.line;
  segment.start_mm = from_mm;
  segment.end_mm = to_mm;
  return {{segment}, false, false};
}

}  // namespace

double runUpMm(const FlowLimits& limits) {
  const Ramp ramp{limits.least(true), limits.jerk_mm_s3};
  return ramp.travelMm(0.0, limits.mark_mm_s) + limits.mark_mm_s * limits.period_s;
}

void addRunUps(std::vector<Run>& runs, double length_mm) {
  std::vector<Run> with;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Run& run = runs[i];
    if (isJump(run)) {
      if (!with.empty()) run.segments.front().start_mm = with.back().segments.back().end_mm;
      with.push_back(std::move(run));
      continue;
    }
    const Segment first = run.segments.front(), last = run.segments.back();
    if (with.empty() || isJump(with.back())) {
      const Eigen::Vector2d from_mm = first.start_mm - length_mm * first.tangentAt(0.0);
      Run up = straight(first, from_mm, first.start_mm);
      if (!with.empty()) with.back().segments.back().end_mm = from_mm;
      up.rests = std::exchange(run.rests, false);
      up.begins_block = std::exchange(run.begins_block, false);
      with.push_back(std::move(up));
    }
    with.push_back(std::move(run));
    if (i + 1 == runs.size() || isJump(runs[i + 1]))
      with.push_back(straight(last, last.end_mm, last.end_mm + length_mm * last.tangentAt(last.lengthMm())));
  }
  runs = std::move(with);
}

}  // namespace kerfbench::planner

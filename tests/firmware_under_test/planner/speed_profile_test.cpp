// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/speed_profile.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/head/axes.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

Segment straight(const Vector2d& from, const Vector2d& to) {
  Segment segment;
  segment.start_mm = from;
  segment.end_mm = to;
  return segment;
}

FlowLimits plain() {
  FlowLimits limits;
  limits.mark_mm_s = limits.jump_mm_s = 200.0;
  limits.acceleration_mm_s2 = limits.jump_acceleration_mm_s2 = 2000.0;
  limits.period_s = Target{}.periodS();
  limits.axes_mm_s = [](const Vector2d&) { return 1e9; };
  return limits;
}

TEST(SpeedProfile, TakesTheTimeOfTheTrapezoid) {
  const std::vector<Segment> run{straight({0, 0}, {60, 80})};
  const SpeedProfile profile(run, plain());
  SpeedProfile::Speeds fast = profile.fastestFrom(0.0);
  const SpeedProfile::Speeds back = profile.fastestTo(0.0);
  for (std::size_t i = 0; i < fast.size(); ++i) fast[i] = std::min(fast[i], back[i]);
  // 100 mm at 200 mm/s and 2000 mm/s²: 0.1 s up, 0.4 s level, 0.1 s down; the peak is reached at a node.
  EXPECT_NEAR(profile.durationS(fast), 0.6, 0.01);
  EXPECT_GE(profile.durationS(fast), 0.6 - 1e-9);
}

TEST(SpeedProfile, IsRealisedInAnyTimeBetweenItsBounds) {
  Segment arc = straight({0, 0}, {20, 0});
  arc.centre_mm = {10, 0};
  arc.sweep_rad = -3.14159265358979;
  const std::vector<Segment> run{straight({0, -15}, {0, 0}), arc};
  const SpeedProfile profile(run, plain());
  const auto fast_from = profile.fastestFrom(100.0);
  const auto fast_to = profile.fastestTo(50.0);
  const auto slow_from = profile.slowestFrom(fast_from.front());
  const auto slow_to = profile.slowestTo(50.0);
  SpeedProfile::Speeds fast, slow;
  for (std::size_t i = 0; i < fast_from.size(); ++i) {
    fast.push_back(std::min(fast_from[i], fast_to[i]));
    slow.push_back(std::max(slow_from[i], slow_to[i]));
  }
  const double shortest_s = profile.durationS(fast);
  for (const double stretch : {1.0, 1.01, 1.1, 1.5, 3.0}) {
    const auto speeds = profile.realise(slow, fast, shortest_s * stretch);
    EXPECT_NEAR(profile.durationS(speeds), shortest_s * stretch, 1e-6 * shortest_s);
    EXPECT_DOUBLE_EQ(speeds.front(), 100.0);
    EXPECT_DOUBLE_EQ(speeds.back(), 50.0);
  }
}

}  // namespace
}  // namespace kerfbench::planner

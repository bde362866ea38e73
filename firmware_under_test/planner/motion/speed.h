// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "firmware_under_test/planner/motion/pieces.h"

namespace kerfbench::planner {

/// Positions of the beam at each end of a period along a run: arc lengths from the run's start, the first 0
/// and the last its length, so a run takes whole periods. It begins and ends at rest.
///
/// S2's limits are kept: top speed, centripetal acceleration, and the distance left to stop, by one pass
/// forward and one backward. Time is then stretched to the next whole period, which keeps all limits. Empty
/// if the axes allow no speed at all.
///
/// With a jerk speeds change along S-curves, without acceleration along the path wherever a limit changes;
/// see Pieces for its shares.
std::vector<double> planRun(std::span<const Segment> run, const SpeedLimits& limits);

/// Motion of one axis from (x0, v0) to rest at x1 in least time under limits of speed and acceleration.
class AxisMove {
 public:
  AxisMove(double x0_mm, double v0_mm_s, double x1_mm, double speed_mm_s, double acceleration_mm_s2);
  [[nodiscard]] double durationS() const { return t_s_[0] + t_s_[1] + t_s_[2]; }
  [[nodiscard]] double at(double t_s) const;

 private:
  double x0_mm_, v0_mm_s_, x1_mm_;
  double peak_mm_s_{};
  double t_s_[3]{};  ///< Durations: speeding up (or turning round), constant speed, slowing down.
};

}  // namespace kerfbench::planner

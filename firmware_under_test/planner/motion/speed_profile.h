// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/motion/corners.h"

namespace kerfbench::planner {

/// Value of a limit that does not limit.
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Bounds of a motion that runs through marks and jumps.
struct FlowLimits {
  double mark_mm_s{};
  double jump_mm_s{};
  double acceleration_mm_s2{};  ///< Acceleration of marks: its length as a vector.
  double jump_acceleration_mm_s2{};
  /// Acceleration of each axis alone, along x and y, that the mirrors allow, see Axes::accelerationBox().
  Eigen::Vector2d box_mm_s2{Eigen::Vector2d::Constant(1e12)};
  /// Ends of the field on the sheet: jumps may not swing out of it. Along a moving belt it has none.
  Eigen::Vector2d low_mm{Eigen::Vector2d::Constant(-1e12)};
  Eigen::Vector2d high_mm{Eigen::Vector2d::Constant(1e12)};
  double period_s{};
  /// Path speed that the axes allow along a unit vector.
  std::function<double(const Eigen::Vector2d& direction)> axes_mm_s;
  double jerk_mm_s3{0.0};  ///< Largest change of the acceleration, see Pieces; 0: no limit.
  CornerLimits corners{};  ///< What the beam may miss of corners.

  /// Acceleration of marks, or of jumps, that no limit forbids, whatever its direction.
  [[nodiscard]] double least(bool jump) const;
};

/// Speeds that a stretch of path admits. Between nodes the path acceleration is constant.
///
/// S2's limits hold at each point: top speed; centripetal acceleration; the distance left to where it must be
/// slower. Of the mirrors' acceleration the bend may take kCentripetalShare; the path's own gets the
/// remainder on each axis, |u_i s''| + |n_i| s'²/R <= a_i. The remainder only grows as the speed falls, so
/// any profile between two admissible ones that is cut off at one speed is admissible too: realise() relies
/// on that.
class SpeedProfile {
 public:
  /// Makes the profile of a stretch with the laser in one state: all marks of one Z, or one jump.
  SpeedProfile(std::span<const Segment> run, const FlowLimits& limits);

  [[nodiscard]] double firstCap() const { return cap_.front(); }  ///< Highest speed at the start, mm/s.
  [[nodiscard]] double lastCap() const { return cap_.back(); }
  [[nodiscard]] double lengthMm() const { return length_mm_; }

  /// Speeds at the nodes.
  using Speeds = std::vector<double>;
  /// Fastest speeds after a start with v_mm_s, and slowest (braking at once).
  [[nodiscard]] Speeds fastestFrom(double v_mm_s) const;
  [[nodiscard]] Speeds slowestFrom(double v_mm_s) const;
  /// Fastest speeds that still end with v_mm_s, and slowest (speeding up at last).
  [[nodiscard]] Speeds fastestTo(double v_mm_s) const;
  [[nodiscard]] Speeds slowestTo(double v_mm_s) const;

  [[nodiscard]] double shortestS(const Speeds& fast) const { return durationS(fast); }
  [[nodiscard]] bool canTake(const Speeds& slow, double total_s) const { return durationS(slow) >= total_s; }
  /// Arc lengths at the end of each of `periods` equal times, of the profile that realise() finds for them.
  [[nodiscard]] std::vector<double> stations(const Speeds& slow, const Speeds& fast, int periods,
                                             double period_s) const;
  /// Duration; infinite if the motion rests between two nodes.
  [[nodiscard]] double durationS(const Speeds& speeds) const;
  /// Profile between slow and fast that is cut off at one speed and takes `total_s`, which must lie between
  /// the durations of the two.
  [[nodiscard]] Speeds realise(const Speeds& slow, const Speeds& fast, double total_s) const;
  /// Arc lengths at the end of each of `periods` equal times, the first 0 and the last the length.
  [[nodiscard]] std::vector<double> stations(const Speeds& speeds, int periods) const;

 private:
  struct Interval {
    double length_mm{};
    double curvature_1_mm{};
    Eigen::Vector2d along{Eigen::Vector2d::Zero()};   ///< Largest |u_i| in the interval.
    Eigen::Vector2d across{Eigen::Vector2d::Zero()};  ///< Largest |n_i| in the interval.
  };
  void add(const Segment& segment, double path_mm_s, const FlowLimits& limits);
  /// Highest speed at the other end of an interval that is entered, or left, with v: the same either way.
  [[nodiscard]] double faster(const Interval& interval, double v_mm_s) const;
  [[nodiscard]] double slower(const Interval& interval, double v_mm_s) const;

  double acceleration_mm_s2_;
  Eigen::Vector2d box_mm_s2_;
  double length_mm_{};
  std::vector<Interval> intervals_;
  std::vector<double> cap_;  ///< Highest speed at each node, mm/s.
};

/// Plans runs without a stop between them, from rest to rest, each in whole periods: for every run its
/// stations, as planRun() gives them. The laser switches where runs meet, exactly at a border of periods.
/// `rests` names the runs before which the motion must rest (the first always does). Empty if the axes allow
/// no motion.
///
/// Global planning as in S2: one pass forward and one backward over all runs give the highest speed at each
/// border; of a ladder of speeds below these the ones are chosen with which all runs together take the fewest
/// periods. With a jerk the acceleration along the path is zero at each border (JerkProfile).
std::vector<std::vector<double>> planFlow(std::span<const std::vector<Segment>> runs,
                                          const std::vector<bool>& rests, const FlowLimits& limits);

}  // namespace kerfbench::planner

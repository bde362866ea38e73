// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/motion/jumps_taken.h"

namespace kerfbench::planner {

/// State on the sheet at the end of one period.
struct Sample {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  double marked_mm{};  ///< Length of path in the period times Z; 0: laser off.
  int line{};          ///< Line of the G-code at the end of the period; 0 if it has none.
  double z{};          ///< Share of a cut's energy that the mark gets; 0: laser off.
};

/// A jump and the marks after it, up to the next jump: runs without a break, since the beam cannot wait for
/// the sheet with the laser on. Smooth jumps lie within a block: a moving beam cannot wait either.
struct Block {
  int entity{-1};
  int line{};
  std::vector<Sample> samples;
  /// Extremes of x_S + v t over the block, t from its start: the range that the moving field must hold.
  double low_mm{};
  double high_mm{};
};

/// One unit in the sheet frame, period by period, for one belt speed.
struct UnitPath {
  Eigen::Vector2d start_S_mm{Eigen::Vector2d::Zero()};
  std::vector<Block> blocks;
  double belt_speed_mm_s{};
  double jump_length_mm{};      ///< Length of path with the laser off, between the marks.
  double acceleration_mm_s2{};  ///< Acceleration of the beam along x while it catches up with the sheet.
  double period_s{};            ///< Period of the controller.
  JumpsTaken jumps;             ///< Jumps of the unit, with a jump radius; without, nothing.
  [[nodiscard]] const Eigen::Vector2d& endS() const { return blocks.back().samples.back().p_S_mm; }
};

/// Place of a unit in time and in the machine: x_W = x_S + x_ref + v (t + tracking delay), t from the start
/// of the unit (S4, eq. 3; the delay leads the drives' lag).
struct UnitLayout {
  double x_ref_mm{};
  int catch_up_periods{};                              ///< Periods from rest to the speed of the belt.
  std::vector<int> waits;                              ///< Periods at rest on the sheet before each block.
  int sheet_periods{};                                 ///< Periods of waits and blocks together.
  Eigen::Vector2d park_W_mm{Eigen::Vector2d::Zero()};  ///< Place where the unit starts, at rest.
  Eigen::Vector2d end_W_mm{Eigen::Vector2d::Zero()};
};

/// Layout, or the reason why there is none.
struct LayoutResult {
  std::optional<UnitLayout> layout;
  std::string reason;
};

/// Plans the periods of one unit; nullopt if the belt is too fast for the x axis. `path` begins and ends with
/// marks but may hold jumps in between. With a jump radius the beam runs through marks and jumps; if stops[k]
/// is set it rests before and after the jump k, so that it can wait there for the sheet, and if `soonest` is
/// set also where that takes less time than arcs (JumpWish). Straight jumps always have these rests.
std::optional<UnitPath> planUnit(const std::vector<Segment>& path, const JobParameters& job, const Axes& axes,
                                 double belt_speed_mm_s, const std::vector<bool>& stops = {},
                                 bool soonest = false);

/// Bounds on the start of a unit other than the field.
struct StartBounds {
  std::optional<double> fixed_x_ref_mm;  ///< Place of a resting sheet.
  double min_x_ref_mm{};  ///< Least x_ref: the belt must have got that far (print mark seen, feed at speed).
  double play_mm{};       ///< Largest excess of x_ref; it may also be smaller by one encoder count.
};

/// Chooses x_ref. As long as no wait is needed, the middle of what the field allows; else the latest start
/// after which every block still finds its place, with waits before those that are yet upstream of the field.
LayoutResult layOut(const UnitPath& unit, const MachineParameters& machine, const StartBounds& bounds);

/// Number of periods of the catch-up. Its speed is v (3 u² - 2 u³): no step of acceleration, 1.5 v / T at
/// most; its length is v T / 2.
int catchUpPeriods(double belt_speed_mm_s, double acceleration_mm_s2, double period_s);
/// Coordinate x_W relative to the park position at time fraction u of the catch-up.
double catchUpMm(double u, double belt_speed_mm_s, int periods, double period_s);

}  // namespace kerfbench::planner

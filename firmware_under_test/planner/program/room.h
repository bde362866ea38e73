// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/motion/solve.h"

namespace kerfbench::planner {

/// Room that a solution takes of the field and of the pitch: S0's two constraints, ramps included.
struct RoomNeeded {
  /// Range of x_W of the beam from park position to the last mark, all units.
  double low_x_mm{}, high_x_mm{};
  double least_pitch_mm{};  ///< Travel of the belt in a cycle, on a moving sheet; else 0.
  double fastest_x_mm_s{};  ///< Highest speed of the beam along x_W while it follows the sheet.
  std::string first,
      last;  ///< Marks at which the beam is at low_x_mm and high_x_mm; empty: not in a mark's run.
};

/// Room of a solution where the belt runs at `belt_speed_mm_s` and not at the speed that it was planned for:
/// the periods stay as they are, and the beam follows the belt through them. Both are 0 on a resting sheet.
RoomNeeded roomAt(const Solution& solution, const MachineParameters& machine, const JobParameters& job,
                  const Axes& axes, double belt_speed_mm_s);

/// Closed form of S0 for a single straight cut across, without ramps: (v_x/v_y)(v_x/v_0 + 1) y0 and v_x y0 /
/// v_y.
struct ClosedFormRoom {
  double least_pitch_mm{}, travel_mm{};
};
/// Nullopt for any other job.
std::optional<ClosedFormRoom> closedFormRoom(const std::vector<Segment>& path,
                                             const MachineParameters& machine, const JobParameters& job,
                                             double belt_speed_mm_s);

/// What does not hold at the lowest or the highest speed that the belt may have, JobParameters::belt_min_mm_s
/// and belt_max_mm_s: S0's v_min <= v_x(t) <= v_max.
std::vector<std::string> beltRangeFaults(const Solution& solution, const MachineParameters& machine,
                                         const JobParameters& job, const Axes& axes);

}  // namespace kerfbench::planner

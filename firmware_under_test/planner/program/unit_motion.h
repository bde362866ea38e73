// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {

/// A period of a unit as the program's operation has it, and what it was planned for.
struct UnitPeriod {
  Eigen::Vector2i steps{
      Eigen::Vector2i::Zero()};  ///< Places of the head's axes at its end, as counted since power-on.
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};  ///< Place of the beam at these steps.
  Eigen::Vector2d p_S_mm{
      Eigen::Vector2d::Zero()};       ///< The same place on the unit, on a belt at nominal speed.
  std::optional<std::uint8_t> power;  ///< PWM with the gate open; nothing: closed.
  Eigen::Vector2d planned_S_mm{Eigen::Vector2d::Zero()};  ///< Place before it became whole steps.
  int line{};  ///< Line of the G-code; of the catch-up and of waits that of the move that follows.
  int entity{-1};
};

/// The periods of one unit of a program, from rest to the last mark.
struct UnitMotion {
  double period_s{};
  UnitPeriod start;  ///< Before the first period.
  std::vector<UnitPeriod> periods;
  int catch_up{};  ///< How many of the periods bring the beam to the sheet's speed.
  /// Place x_W of the unit's origin at the start, with the lead of the tracking delay; the sheet then moves
  /// at this speed: x_W = x_S + x_ref_mm + belt_mm_s t.
  double x_ref_mm{};
  double belt_mm_s{};
};

/// Reads the operations of a unit, as the controller would, and takes the steps back to places on the sheet
/// by the head's own axes, its correction included. The belt is where the program's print mark and offset,
/// its feed steps, or the resting sheet put it; its speed is the nominal one, whatever `faults` the program
/// was written with. @pre the program is of this solution and job. @throws PlanError if the correction table
/// has no place for the steps.
UnitMotion unitMotion(const Program& program, int unit, const Solution& solution,
                      const MachineParameters& machine, const JobParameters& job, const Axes& axes);

}  // namespace kerfbench::planner

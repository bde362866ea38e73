// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware_under_test/planner/program/plan.h"

namespace kerfbench::planner {

/// One interpolation period of a job, as its table holds it.
struct TablePeriod {
  int x_steps{}, y_steps{};  ///< -31 … 31
  int power{-1};             ///< Duty of the laser in 1/256, 0 … 255; -1: the gate is closed.
  friend bool operator==(const TablePeriod&, const TablePeriod&) = default;
};

/// Commands among the periods of a table.
enum class TableCommand : std::uint8_t {
  kEnd,       ///< The job is done.
  kWaitMark,  ///< The next period begins a fixed time after the next print mark.
  kUnitDone,  ///< After the last unit the table goes on at JobTable::final.
  kNextUnit   ///< The table goes on at JobTable::loop.
};

/// A whole job in the code memory of an 8051.
///
/// A period takes two bytes. b0: bits 7..3 steps of X, bit 0 level of DIR X (low: +x), bit 1 the laser is on,
/// bit 2 a byte with its power follows. b1: bits 7..3 steps of Y, bit 0 level of DIR Y, bit 1 a byte follows
/// (after the power), how often the period is run, 2 … 255; bit 2: b0 is a TableCommand, and no period.
/// An axis without steps keeps its DIR; units that are alike are written once.
struct JobTable {
  std::vector<std::uint8_t> bytes;
  std::size_t loop{}, final{};  ///< Places in `bytes`.
  int units{};                  ///< Units that the loop runs, 1 … 65535.
  int mark_ticks{};             ///< Ticks from a print mark to the begin of its unit.
  std::size_t periods{};        ///< Periods that the table describes, runs and loops not counted.
};

/// Writes a program that follows no belt encoder as a table. @param first_axis Number of X in the protocol.
/// @throws PlanError for operations that such a table does not have: feed steps, units that begin at
/// different distances from their marks, more than 65535 units.
JobTable tableOf(const Program& program, int first_axis);

}  // namespace kerfbench::planner

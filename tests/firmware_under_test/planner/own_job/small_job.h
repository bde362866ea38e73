// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/own_job/own_job.h"

namespace kerfbench::planner::test {

/// A rounded rectangle of 20 x 16 mm, x in [-20, 0], radius 3, three times on a web at 25 mm/s, the
/// print-mark sensor close by so that the job is short.
MachineParameters smallMachine();
JobParameters smallJob();
OwnJob makeSmallJob(const Mcs51Controller& controller);
/// Distance from its outline, mm.
double distanceFromOutline(const Eigen::Vector2d& p_S_mm);

/// A period of a control program, as its text has it.
struct Shown {
  Eigen::Vector2i steps;  ///< Place of the axes at its end, from the start.
  Eigen::Vector2i dirs;   ///< Levels of DIR.
  int power{-1};          ///< -1: gate closed.
  int unit{-1};           ///< Unit, counted by its marks.
  int since_mark{};       ///< Periods since the unit began, this one counted.
};

/// Runs through the table in the text of a control program, by the comment above it alone. Fails the test
/// where the table leaves its format.
std::vector<Shown> periodsIn(const std::string& source, const JobTable& table);

}  // namespace kerfbench::planner::test

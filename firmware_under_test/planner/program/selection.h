// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/process.h"

namespace kerfbench::planner {

/// Part of a job that is to be cut: an entity must be among those of each list that is not empty.
struct Selection {
  EntityRanges entities;
  std::set<std::string> layers;  ///< Lower case; DXF layers or SVG colours.
  std::set<dieline::Process> processes;

  [[nodiscard]] bool all() const { return entities.empty() && layers.empty() && processes.empty(); }
};

/// Parses the words of the command line: "3,5-8" (an E before a number may be there), "Cut,Crease",
/// "cut,half-cut". Empty text: no limit of that kind. @throws PlanError with everything wrong.
Selection selectionFrom(const std::string& entities, const std::string& layers, const std::string& processes);

/// Excludes what is not chosen by dieline::Process::kIgnore, so that planner and judge leave it out. What it
/// was drawn for is kept in Entity::left_out, because it still takes part in the nesting.
/// @throws PlanError if a range or a layer chooses nothing that is in the drawing, or all together choose
/// nothing.
void select(dieline::Dieline& dieline, const Selection& selection);

/// Selects marks of a G-code, in their order, with jumps between them. Entity and process are those of the
/// comments that makeGcode writes: "(E14 cut)"; marks without one belong to no entity and no process.
/// @throws PlanError if the text is faulty or nothing is chosen, and for layers, which G-code does not hold.
std::string select(const std::string& gcode, const Selection& selection);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

/// What a drawing costs in one order.
struct OrderCost {
  JobParameters::Order order{};
  int jumps{};
  double air_path_mm{};
  std::optional<double> unit_time_s;  ///< Absent: it does not fit at the job's belt speed.
  double max_belt_speed_mm_s{};       ///< 0 on a resting sheet.
};

/// Shortest, nearest, drawn. @throws PlanError if parameters or drawing are unusable.
std::vector<OrderCost> orderCosts(const dieline::Dieline& dieline, const MachineParameters& machine,
                                  JobParameters job);

/// The same as a table to read.
std::string orderTable(const dieline::Dieline& dieline, const MachineParameters& machine,
                       const JobParameters& job);

}  // namespace kerfbench::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/job.h"
#include "hil/dieline/process.h"

namespace kerfbench::planner {

/// Cost of a drawing in one order.
struct OrderCost {
  JobParameters::Order order{};
  int jumps{};
  double air_path_mm{};
  std::optional<double> unit_time_s;  ///< Time of a unit; absent: it does not fit at the job's belt speed.
  double max_belt_speed_mm_s{};       ///< Highest belt speed; 0 on a resting sheet.
};

/// Costs of the orders shortest, nearest, drawn. @throws PlanError if parameters or drawing are unusable.
std::vector<OrderCost> orderCosts(const dieline::Dieline& dieline, const MachineParameters& machine,
                                  JobParameters job);

/// Table of orderCosts() for people.
std::string orderTable(const dieline::Dieline& dieline, const MachineParameters& machine,
                       const JobParameters& job);

}  // namespace kerfbench::planner

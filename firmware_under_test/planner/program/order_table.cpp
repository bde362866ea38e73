// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/order_table.h"

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/plan.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {

std::vector<OrderCost> orderCosts(const dieline::Dieline& dieline, const MachineParameters& machine,
                                  JobParameters job) {
  using Order = JobParameters::Order;
  std::vector<OrderCost> costs;
  for (const Order order : {Order::kShortest, Order::kNearest, Order::kDrawn}) {
    job.order = order;
    const std::string gcode = makeGcode(dieline, machine, job);
    OrderCost cost;
    cost.order = order;
    for (const Segment& segment : unitOf(readGcode(gcode))) {
      if (!segment.jump) continue;
      ++cost.jumps;
      cost.air_path_mm += segment.lengthMm();
    }
    const CheckResult checked = checkJob(gcode, machine, job);
    if (job.belt_speed_mm_s > 0.0) cost.max_belt_speed_mm_s = checked.max_belt_speed_mm_s;
    if (checked.solution) {
      const UnitLayout& layout = checked.solution->layoutOf(0);
      cost.unit_time_s = (layout.catch_up_periods + layout.sheet_periods) * machine.target.periodS();
    }
    costs.push_back(cost);
  }
  return costs;
}

std::string orderTable(const dieline::Dieline& dieline, const MachineParameters& machine,
                       const JobParameters& job) {
  constexpr const char* kNames[] = {"shortest", "nearest", "drawn"};
  std::string text = fmt::format("{:<10}{:>7}{:>14}{:>14}{:>20}\n", "order", "jumps", "air path, mm",
                                 "unit time, s", "belt at most, mm/s");
  for (const OrderCost& cost : orderCosts(dieline, machine, job)) {
    text += fmt::format(
        "{:<10}{:>7}{:>14.1f}{:>14}{:>20}\n", kNames[static_cast<int>(cost.order)], cost.jumps,
        cost.air_path_mm, cost.unit_time_s ? fmt::format("{:.4f}", *cost.unit_time_s) : "does not fit",
        cost.max_belt_speed_mm_s > 0.0 ? fmt::format("{:.2f}", cost.max_belt_speed_mm_s) : "–");
  }
  return text;
}

}  // namespace kerfbench::planner

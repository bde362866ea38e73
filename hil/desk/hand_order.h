// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// POST /api/order: {"order": [id …]} is written into the scenario as `planner.order: [3, 0, "5-8"]`; an
/// empty list takes it out again. Gives {"text", "order": [id …], "issues": […]}; order is the whole one, as
/// it would be cut; issues as of checkJson(): errors where the order is not sound (an entity that is not cut,
/// twice, or forgotten), warnings where it is doubtful (a hole after the outline around it, a crease after
/// cuts).
/// @throws base::InputError for a scenario or drawing that cannot be read.
std::string orderJson(const ScenarioText& scenario, const std::vector<int>& order,
                      const DeskRequest& request);

}  // namespace kerfbench::desk

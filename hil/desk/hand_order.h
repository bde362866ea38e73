// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// An order as `planner.order` has it: ascending neighbours as ranges, "[3, 0, 5-8]" without the brackets as
/// a list of texts.
std::vector<std::string> orderWords(const std::vector<int>& order);

/// POST /api/order: writes `planner.order: [3, 0, 5-8]` into the scenario, or takes it out where `order` is
/// empty. Gives {"text", "order": [id …], "issues": […]}: order is the whole one as it would be cut, by the
/// planner where none is given; issues are those of checkJson(): errors where the order is not one of this
/// drawing (an entity that is not cut, twice, forgotten), warnings where it is doubtful (a hole or a crease
/// after the outline around it). @throws base::InputError for a text that cannot be edited.
std::string orderJson(const ScenarioText& scenario, const std::vector<int>& order,
                      const DeskRequest& request);

}  // namespace kerfbench::desk

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// POST /api/plan: the job that the scenario would send to its controller, and what the program's own periods
/// do. With `gcode` this text is planned as the scenario's planner.gcode would be.
///
///     {"fits": bool,
///      "issues": [{"line", "message", "severity", "source": "gcode" | "job", "where_mm"?, "entities"?}],
///      "gcode": text,
///      "facts": null | {"unit_time_s", "cycle_time_s", "max_belt_speed_mm_s", "cut_length_mm",
///                       "jump_length_mm", "units", "periods"},
///      "preview": null | {"period_s", "stride", "x_mm": [], "y_mm": [], "power": [], "gate": [],
///                         "line": [[line, n] …], "entity": [[id, n] …], "speed_mm_s": [],
///                         "field": {"min_mm", "max_mm", "ref_x_mm", "belt_mm_s"}},
///      "entity_lines": [{"entity", "line_first", "line_last"}],
///      "order": [id …]}
///
/// x_mm, y_mm: ends of the periods of the first unit in S, from the steps of the program (decode.h), the
/// first the place at which it starts; at period i the reach of the beam on the sheet is field.min_mm …
/// field.max_mm less ref_x_mm + belt_mm_s · i · period_s along x. Of a unit longer than kMostPeriodsShown
/// each stride-th period is given. Where the G-code is by hand, warnings tell which of its lines cut away
/// from the drawing by more than the scenario's checks.path_mm, and what of the drawing none cuts. A job that
/// does not fit has issues and, if its G-code can be read, no preview. @throws base::InputError for a
/// scenario that no planner serves (dialog: line-ok, none), and for one that cannot be read, with its faults.
std::string planJson(const ScenarioText& scenario, const std::optional<std::string>& gcode,
                     const DeskRequest& request);

inline constexpr std::size_t kMostPeriodsShown = 200'000;

}  // namespace kerfbench::desk

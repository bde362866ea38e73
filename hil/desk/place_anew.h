// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// POST /api/place: lays the drawing of a scenario anew, as a first scenario has it: registration marks,
/// pitch and start follow from the size that the drawing has now, the shift across the web where it leaves
/// the field. With `unit` ("mm", "cm", "in", "pt" or "px") the drawing is read in it from now on. Gives
/// {"text"}, in which all else is as it was. Where the belt runs the start is left to the planner.
/// @throws base::InputError for a text that cannot be edited or read, DielineError, ConfigError.
std::string placeJson(const ScenarioText& scenario, const std::optional<std::string>& unit,
                      const DeskRequest& request);

}  // namespace kerfbench::desk

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hil/desk/desk_request.h"

// Private to hil/desk.
namespace kerfbench::desk {

/// Keys of a scenario with their values, flat: "belt.speed_mm_s". Lists are values as a whole, and so are the
/// sections whose keys are names of the user's own (layers, wires, lines, outputs, settings, controls).
struct ScenarioValues {
  nlohmann::ordered_json all;    ///< As this text and the files that it extends say together.
  std::vector<std::string> own;  ///< Paths of those that this text says itself.
};
/// @throws base::InputError for texts that cannot be read so.
ScenarioValues valuesOf(const ScenarioText& scenario);

}  // namespace kerfbench::desk

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "twin/scene/moving_scene.h"

namespace kerfbench::trace {

/// The machine in 3-D as /machine has it: `bodies`, `parts`, `beam`, and of `views` `overall` and `head`.
nlohmann::ordered_json jsonOf(const twin::MovingScene& scene);

/// The same machine out of a message of /machine. @throws nlohmann::json::exception, or std::out_of_range for
/// an unknown name.
twin::MovingScene movingSceneFrom(const nlohmann::ordered_json& machine);

}  // namespace kerfbench::trace

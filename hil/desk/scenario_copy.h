// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/desk/desk_request.h"

namespace kerfbench::desk {

/// Text of a scenario for another folder: the names of files that this text itself gives, `extends` among
/// them, and that are beside its own folder, lead to the same files from there; `name` becomes that of `to`.
/// All else stays byte for byte. @throws base::InputError as edited().
std::string copiedScenario(const ScenarioText& scenario, const std::filesystem::path& to,
                           const DeskRequest& request);

}  // namespace kerfbench::desk

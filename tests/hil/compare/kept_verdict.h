// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace kerfbench::compare {

/// verdict.json of a run in which nothing is measured but the check `path`, one line and one cut.
nlohmann::json plainVerdict();

/// Keeps a verdict as a run does: results_dir/NAME/DATE-DIGEST, so many seconds after the first.
/// Returns the folder.
std::filesystem::path keep(const nlohmann::json& verdict, const std::filesystem::path& results_dir,
                           int seconds = 0);

}  // namespace kerfbench::compare

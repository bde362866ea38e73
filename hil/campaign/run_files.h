// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/grid.h"

namespace kerfbench::campaign {

/// "000012": the number of a run as its files are named.
std::string runName(std::size_t index);

/// The files of one run: a scenario that extends its base and gives the keys that the campaign changes, and a
/// machine that extends the base's, if keys of it are changed. `kerfbench run` takes the scenario as it is.
struct RunFiles {
  std::string scenario;
  std::optional<std::string> machine;  ///< Beside it, as "000012.machine.yaml".
};

/// @param folder  Where the files will be, absolute: the names of other files in them are relative to it.
/// @throws base::ConfigError: a change needs a number that the base does not give; the base's machine is
/// missing.
RunFiles runFilesOf(const Campaign& campaign, const RunPlan& plan, const std::filesystem::path& folder);

/// Writes the files of a run that are not there as they should be, each whole or not at all. Returns the path
/// of the scenario.
/// @throws as runFilesOf(); std::system_error.
std::filesystem::path writeRunFiles(const Campaign& campaign, const RunPlan& plan,
                                    const std::filesystem::path& folder);

}  // namespace kerfbench::campaign

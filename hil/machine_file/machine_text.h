// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "hil/machine_file/machine_file.h"

namespace kerfbench::machine_file {

/// Reads `text` as if it were the machine file `path`, which need not be there.
/// @throws ConfigError as readMachineFile().
MachineFile readMachineText(const std::filesystem::path& path, const std::string& text);

}  // namespace kerfbench::machine_file

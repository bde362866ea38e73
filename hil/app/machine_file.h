// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "twin/cutter/description.h"

namespace kerfbench::hil {

/// Reads a machine (fixtures/machines/two-mirror.yaml explains every key). Drive profiles are named there and
/// looked up in the file that `drivers` names. @throws ConfigError with every fault, each with file and line.
twin::MachineDescription readMachine(const std::filesystem::path& path);

}  // namespace kerfbench::hil

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/scenario/case.h"

namespace kerfbench::run {

/// Holds a scenario for one of the bench's emulators against what that has: its controller, the ports of the
/// machine's pins, the UART of its dialog. Others are left to their own child. `bin_dir`: where kerfbench's
/// children are.
/// @throws ConfigError with every fault, each with file and line.
void refuseUnfitController(const scenario::Case& test_case, const std::filesystem::path& bin_dir);

}  // namespace kerfbench::run

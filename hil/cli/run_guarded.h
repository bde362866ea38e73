// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "hil/base/exit_codes.h"

namespace kerfbench::cli {

/// Does the work for a scenario and returns its exit code. Bad input of the user is told in his words on
/// standard error: base::kExitInput. A model that has left the realm of numbers says nothing about the
/// firmware: time and joint on standard error, base::kExitBroken. Anything else passes through.
int runGuarded(const std::filesystem::path& scenario, const std::function<int()>& work);

}  // namespace kerfbench::cli

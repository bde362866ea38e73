// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace kerfbench::hil {

/// Does the work of a command that calibrates a head: as guarded(), and marks or pictures that cannot be
/// trusted are told on standard error, then "INVALID: " and `so`, with exit code 3. A sheet that is to be cut
/// by hand is told on standard output, kExitWaiting.
int guardedHead(const std::filesystem::path& machine, const std::string& so,
                const std::function<int()>& work);

}  // namespace kerfbench::hil

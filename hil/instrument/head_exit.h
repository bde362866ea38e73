// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// Marks along a side of the densest sheet of `calibrate head`; other sheets have marks of the same size.
inline constexpr int kDensest = 17;

/// Does the work of a command that calibrates a head: as cli::runGuarded(), and marks or pictures that cannot
/// be trusted are told on standard error, then "INVALID: " and `so`, with exit code 3. A sheet that is to be
/// cut by hand is told on standard output, base::kExitWaiting.
int guardedHead(const std::filesystem::path& machine, const std::string& so,
                const std::function<int()>& work);

}  // namespace kerfbench::instrument

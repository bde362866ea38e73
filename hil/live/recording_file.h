// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/base/progress.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::live {

/// A recording of a case's pins: VCD, or a session file of sigrok (.sr), whose channels may have the names
/// that the case has for an analyser's. A session whose rate is too low for the drives' pulses has a problem.
/// @throws InputError listing every fault.
source::PinRecording readRecording(const std::filesystem::path& path, const scenario::Case& test_case,
                                   const base::ProgressFn& progress = {});

}  // namespace kerfbench::live

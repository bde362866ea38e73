// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/app/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::hil {

/// A recording of a case's pins: VCD, or a session file of sigrok (.sr), whose channels may have the names
/// that the case has for an analyser's. A session whose rate is too low for the drives' pulses has a problem.
/// @throws InputFault listing every fault.
PinRecording readRecording(const std::filesystem::path& path, const Case& the_case);

}  // namespace kerfbench::hil

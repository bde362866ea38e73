// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/inspect/evidence/evidence.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// Why a cut is bad, if the laser's gate is open between the cuts and closed in them, in a sentence for
/// people; else empty. By the pins and the drawing alone. `evidence`: the pins' gates, light and belt.
std::string gateCause(const scenario::Case& test_case, const source::PinRecording& recording,
                      const inspect::Evidence& evidence);

}  // namespace kerfbench::judge

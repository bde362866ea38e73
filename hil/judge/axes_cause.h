// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/inspect/evidence/evidence.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// Why a cut is bad, if the head's axes are swapped, run backwards or have another scale, in sentences for
/// people; else empty. By the pins and the drawing alone: it tells as well where the spot was never seen.
/// `evidence`: the pins' light and belt.
std::string axesCause(const scenario::Case& test_case, const source::PinRecording& recording,
                      const inspect::Evidence& evidence);

}  // namespace kerfbench::judge

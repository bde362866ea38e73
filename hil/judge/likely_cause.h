// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// Why a cut is bad, in sentences for people; else empty. By pins, drawing and failing checks alone:
/// - the laser's gate is open between the cuts and closed in them;
/// - the head's axes are swapped, run backwards or have another scale: told where the spot was never seen as
/// well;
/// - corners are burnt, or get too much energy, and the laser keeps its power where the beam is slow;
/// - a corner is missed though the pulses lead to it while the laser shines: the axes do not follow what they
/// are asked for.
/// `evidence`: the pins' light, belt, gates and pulses.
std::string likelyCause(const scenario::Case& test_case, const source::PinRecording& recording,
                        const inspect::Evidence& evidence, const inspect::InspectionResult& result);

}  // namespace kerfbench::judge

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// Why a cut is bad, each in a sentence for people or empty; the first that is found leaves the others empty.
/// By pins, drawing and failing checks alone.
struct PlainCauses {
  std::string gate;  ///< The laser's gate is open between the cuts and closed in them.
  /// The head's axes are swapped, run backwards or have another scale: told where the spot was never seen as
  /// well.
  std::string axes;
  /// Corners are burnt, or get too much energy, and the laser keeps its power where the beam is slow.
  std::string steady_power;
  /// A corner is missed though the pulses lead to it while the laser shines: the axes do not follow what they
  /// are asked for.
  std::string corners;
};

/// `evidence`: the pins' light, belt, gates and pulses.
PlainCauses plainCauses(const scenario::Case& test_case, const source::PinRecording& recording,
                        const inspect::Evidence& evidence, const inspect::InspectionResult& result);

}  // namespace kerfbench::judge

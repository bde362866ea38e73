// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/evidence/counted_steps.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/judge/pin_wiring.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::benchmarks {

/// What a verdict takes from a recording of pins alone.
struct PinAccount {
  evidence::PinEvidence pins;           ///< Timing of all drives, gate, light.
  evidence::CountedSteps::Steps end{};  ///< Places of the mirrors, steps from the start.
};

/// Positions over time, and all checks of timing.
inline PinAccount accountOf(const source::PinRecording& recording, const scenario::Case& test_case) {
  const evidence::PinWiring wiring = judge::pinWiring(test_case);
  PinAccount account{evidence::pinEvidence(recording, wiring), {}};
  if (const auto steps = evidence::CountedSteps::of(recording, wiring))
    account.end = steps->at(recording.rate.seconds(recording.end));
  return account;
}

}  // namespace kerfbench::benchmarks

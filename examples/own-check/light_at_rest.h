// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/evidence/pin_evidence.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/source/vcd.h"

namespace own {

/// Check of one's own: the longest time for which the laser emits while no drive is stepped. A beam that
/// stands still burns a hole, whatever the cut looks like elsewhere.
///
/// The value is in ms; `limit_ms` > 0. It is a time between two edges of the recording, so it is as uncertain
/// as these are. Without any light in the recording it is INVALID.
kerfbench::inspect::Check lightAtRest(const kerfbench::source::PinRecording& recording,
                                      const kerfbench::evidence::PinWiring& wiring, double limit_ms);

}  // namespace own

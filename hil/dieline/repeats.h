// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/dieline/faults.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// Leaves out each line that lies wholly on another of its process, to kOverlap_mm, so that it is cut once:
/// of two that are alike the second, else the shorter one. Numbers the others anew and notes how many were
/// left out. A line that lies on another in part stays. A drawing with too many lines on each other is a
/// fault.
void leaveOutRepeats(Dieline& dieline, FaultList& faults);

}  // namespace kerfbench::dieline

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/program/payload.h"

namespace kerfbench::planner {

/// Payload of KB_POWER: gain and curve of the loop on the measured power. A measurement belongs to the power
/// that was commanded the delay of the gate, the laser's own lag and the meter's delay before.
/// @pre job.power is set, and jobIssues() finds nothing.
Payload powerLoopPayload(const MachineParameters& machine, const JobParameters& job,
                         unsigned gate_delay_ticks);

}  // namespace kerfbench::planner

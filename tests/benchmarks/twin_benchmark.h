// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {

/// The whole twin on the pins of a run, one core, no pictures: sensors, machine, beam, laser, sheet.
void registerTwinBenchmarks(const RecordedRun& run);

}  // namespace kerfbench::benchmarks

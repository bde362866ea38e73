// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {

/// What the first marks of a label cost, and how exact they are: the twin's model in both fidelities, and
/// Bullet's stepSimulation as it comes and with the step that would make it as exact as the reference.
void registerBulletBenchmarks(const RecordedRun& label);

}  // namespace kerfbench::benchmarks

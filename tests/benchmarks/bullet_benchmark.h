// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {

/// Registers the cost and the accuracy of the first marks of a label: the twin's model in both fidelities,
/// and Bullet's stepSimulation as it comes and with the step that would make it as exact as the reference.
void registerBulletBenchmarks(const RecordedRun& label);

}  // namespace kerfbench::benchmarks

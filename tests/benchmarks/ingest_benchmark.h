// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {

/// Writes the pins of a run as `run.vcd` into a folder, which is made if need be, and again and again behind
/// each other as `edges.vcd`. Registers how fast readVcd() makes a checked recording of each, and how fast a
/// plain loop of std::getline only reads the lines of the latter. All count the changes of wires.
void registerIngestBenchmarks(const RecordedRun& run, const std::filesystem::path& folder);

}  // namespace kerfbench::benchmarks

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/scenario/case.h"
#include "tests/benchmarks/recorded_run.h"

namespace kerfbench::benchmarks {

/// Writes the pins of a run as `run.vcd` into a folder, which is made if need be, sampled at 1 MHz as
/// `run.sr`, and again and again behind each other as `edges.vcd`. Registers how fast readVcd() and readSr()
/// make a checked recording of each, how fast that of one run becomes positions and checks of timing, and how
/// fast a plain loop of std::getline only reads the lines of the last. All count the changes of wires.
/// `test_case`: that of the run.
void registerIngestBenchmarks(const RecordedRun& run, const scenario::Case& test_case,
                              const std::filesystem::path& folder);

}  // namespace kerfbench::benchmarks

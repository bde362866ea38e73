// SPDX-License-Identifier: Apache-2.0
// Speed of the twin and of reading pins, nothing of it asserted. `./bench benchmark twin` builds and runs it.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <vector>

#include "tests/benchmarks/bullet_benchmark.h"
#include "tests/benchmarks/ingest_benchmark.h"
#include "tests/benchmarks/twin_benchmark.h"

int main(int argc, char** argv) {
  using namespace kerfbench::benchmarks;
  namespace fs = std::filesystem;
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 64;
    const fs::path scenarios = fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/scenarios/native";
    const fs::path bin = fs::path(KERFBENCH_BINARY_DIR) / "bin";
    std::vector<RecordedRun> runs;
    for (const char* name : {"label-on-belt", "carton-on-belt", "strip-crosscut"}) {
      std::printf("recording %s\n", name);
      std::fflush(stdout);
      runs.push_back(record(scenarios / (std::string(name) + ".yaml"), bin));
    }
    for (const RecordedRun& run : runs) registerTwinBenchmarks(run);
    registerBulletBenchmarks(runs.front());
    registerIngestBenchmarks(
        runs.front(),
        kerfbench::scenario::readCase(scenarios / "label-on-belt.yaml", bin.parent_path() / "firmware"),
        fs::path(KERFBENCH_BINARY_DIR) / "benchmarks");
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "kerfbench-benchmarks: %s\n", e.what());
    return 2;
  }
  return 0;
}

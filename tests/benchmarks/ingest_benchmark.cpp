// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/ingest_benchmark.h"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <string>

#include "hil/source/vcd.h"

namespace kerfbench::benchmarks {
namespace {

constexpr std::size_t kEvents = 4'000'000;

/// Lines that say that a wire has changed.
std::size_t changesByLines(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::size_t changes = 0;
  for (std::string line; std::getline(file, line);)
    changes += !line.empty() && (line[0] == '0' || line[0] == '1') ? 1U : 0U;
  return changes;
}

void countEdges(benchmark::State& state, std::size_t edges) {
  state.counters["edges/s"] = benchmark::Counter(
      static_cast<double>(edges) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["edges"] = static_cast<double>(edges);
}

}  // namespace

void registerIngestBenchmarks(const RecordedRun& run, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const SignalMap map = run.machine.signals;
  const auto checked = [&](const char* name, const std::filesystem::path& path, std::size_t times) {
    source::writeVcd(path, repeated(run, times), map);
    const std::size_t edges = changesByLines(path);
    std::printf("%zu edges in %s\n", edges, path.c_str());
    benchmark::RegisterBenchmark(name, [path, map, edges](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(source::readVcd(path, map));
      countEdges(state, edges);
    })->Unit(benchmark::kMillisecond);
    return edges;
  };
  checked("recording of one run, checked", folder / "run.vcd", 1);
  const std::filesystem::path path = folder / "edges.vcd";
  const std::size_t edges = checked("recording, checked", path, kEvents / run.events.size() + 1);
  benchmark::RegisterBenchmark("recording, lines alone", [path, edges](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(changesByLines(path));
    countEdges(state, edges);
  })->Unit(benchmark::kMillisecond);
}

}  // namespace kerfbench::benchmarks

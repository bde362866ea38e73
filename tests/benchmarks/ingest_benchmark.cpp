// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/ingest_benchmark.h"

#include <benchmark/benchmark.h>

#include <bit>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <string>

#include "hil/source/analyser/sr_file.h"
#include "hil/source/vcd.h"
#include "tests/benchmarks/pin_account.h"

namespace kerfbench::benchmarks {
namespace {

constexpr std::size_t kEvents = 4'000'000;
constexpr Tick kSessionTicks = 16;  ///< A sample each microsecond.

/// Lines that say that a wire has changed.
std::size_t changesByLines(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::size_t changes = 0;
  for (std::string line; std::getline(file, line);)
    changes += !line.empty() && (line[0] == '0' || line[0] == '1') ? 1U : 0U;
  return changes;
}

/// Changes of wires.
std::size_t edgesOf(const source::PinRecording& recording) {
  std::size_t edges = recording.sensors.size();
  for (const PinEvent& event : recording.outputs)
    edges += static_cast<std::size_t>(std::popcount(event.changed));
  return edges;
}

/// A recording as an analyser makes it that samples each `ticks`. No pin of it changes twice within them.
source::PinRecording sampled(const source::PinRecording& recording, Tick ticks) {
  source::PinRecording samples;
  samples.rate = {recording.rate.num * ticks, recording.rate.den};
  while (samples.rate.num % 2 == 0 && samples.rate.den % 2 == 0) {
    samples.rate.num /= 2;
    samples.rate.den /= 2;
  }
  for (PinEvent event : recording.outputs) {
    event.tick /= ticks;
    samples.outputs.push_back(event);
  }
  samples.end = recording.end / ticks;
  return samples;
}

void countEdges(benchmark::State& state, std::size_t edges) {
  state.counters["edges/s"] = benchmark::Counter(
      static_cast<double>(edges) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["edges"] = static_cast<double>(edges);
}

}  // namespace

void registerIngestBenchmarks(const RecordedRun& run, const scenario::Case& test_case,
                              const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const SignalMap map = run.machine.signals;
  const auto measured = [](const char* name, const std::filesystem::path& path, std::size_t edges,
                           auto work) {
    std::printf("%zu edges in %s\n", edges, path.c_str());
    benchmark::RegisterBenchmark(name, [edges, work](benchmark::State& state) {
      for (auto _ : state) benchmark::DoNotOptimize(work());
      countEdges(state, edges);
    })->Unit(benchmark::kMillisecond);
  };
  const std::filesystem::path one = folder / "run.vcd";
  source::writeVcd(one, repeated(run, 1), map);
  const std::size_t edges_of_one = changesByLines(one);
  measured("recording of one run, checked", one, edges_of_one, [=] { return source::readVcd(one, map); });
  measured("recording of one run, positions and timing", one, edges_of_one,
           [=] { return accountOf(source::readVcd(one, map), test_case).end; });

  const std::filesystem::path session = folder / "run.sr";
  const source::PinRecording samples = sampled(repeated(run, 1), kSessionTicks);
  source::writeSr(session, samples, map);
  measured("session of one run, checked", session, edgesOf(samples),
           [=] { return source::readSr(session, map, {}); });

  const std::filesystem::path many = folder / "edges.vcd";
  source::writeVcd(many, repeated(run, kEvents / run.events.size() + 1), map);
  const std::size_t edges = changesByLines(many);
  measured("recording, checked", many, edges, [=] { return source::readVcd(many, map); });
  measured("recording, lines alone", many, edges, [=] { return changesByLines(many); });
}

}  // namespace kerfbench::benchmarks

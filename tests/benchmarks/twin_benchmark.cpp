// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/twin_benchmark.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

namespace kerfbench::benchmarks {
namespace {

void playRun(benchmark::State& state, const RecordedRun& run, double length_s, twin::Fidelity fidelity) {
  double simulated_s = 0.0;
  const Tick end = run.rate.ticksAt(length_s);
  for (auto _ : state) simulated_s += play(run, end, {.fidelity = fidelity});
  state.counters["x real time"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  state.counters["simulated s"] = benchmark::Counter(simulated_s, benchmark::Counter::kAvgIterations);
}

}  // namespace

void registerTwinBenchmarks(const RecordedRun& run) {
  const auto shared = std::make_shared<const RecordedRun>(run);
  const auto add = [&](const std::string& mode, double length_s, twin::Fidelity fidelity) {
    benchmark::RegisterBenchmark(("twin, " + mode + ": " + run.name).c_str(), [shared, length_s, fidelity](
                                                                                  benchmark::State& state) {
      playRun(state, *shared, length_s, fidelity);
    })->Unit(benchmark::kMillisecond);
  };
  const double whole_s = run.rate.seconds(run.end);
  add("reference", whole_s, twin::Fidelity::kReference);
  add("fast", whole_s, twin::Fidelity::kFast);
}

}  // namespace kerfbench::benchmarks

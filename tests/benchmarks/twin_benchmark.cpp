// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/twin_benchmark.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "twin/description/imperfections.h"

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
  const auto ideal = std::make_shared<const RecordedRun>(run);
  // Backlash, slip, flutter and noise make a step expensive.
  auto dynamic = std::make_shared<RecordedRun>(run);
  dynamic->machine = twin::drawImperfections(run.machine, {}, twin::Preset::kDynamic, 1).machine;
  const double whole_s = run.rate.seconds(run.end);
  const auto add = [&](const std::string& mode, const std::shared_ptr<const RecordedRun>& played,
                       twin::Fidelity fidelity) {
    benchmark::RegisterBenchmark(("twin, " + mode + ": " + run.name).c_str(), [played, whole_s, fidelity](
                                                                                  benchmark::State& state) {
      playRun(state, *played, whole_s, fidelity);
    })->Unit(benchmark::kMillisecond);
  };
  add("reference", ideal, twin::Fidelity::kReference);
  add("fast", ideal, twin::Fidelity::kFast);
  add("reference, dynamic imperfections", dynamic, twin::Fidelity::kReference);
  add("fast, dynamic imperfections", dynamic, twin::Fidelity::kFast);
}

}  // namespace kerfbench::benchmarks

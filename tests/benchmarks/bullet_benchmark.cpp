// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/bullet_benchmark.h"

#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "tests/benchmarks/spot_track.h"
#include "twin/cutter/machine_model.h"

namespace kerfbench::benchmarks {
namespace {

constexpr double kLength_s = 0.05;

void countTime(benchmark::State& state, double simulated_s, double error_mm) {
  state.counters["x real time"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  state.counters["spot error um"] = 1e3 * error_mm;
}

void stepTwin(benchmark::State& state, const Stretch& stretch, twin::Fidelity fidelity, double error_mm) {
  double simulated_s = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(twinTrack(stretch, fidelity));
    simulated_s += stretch.length_s;
  }
  countTime(state, simulated_s, error_mm);
}

void stepBullet(benchmark::State& state, const Stretch& stretch, double step_s, double error_mm) {
  auto machine = std::make_unique<BulletMachine>(stretch, step_s);
  double simulated_s = 0.0;
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i) machine->step();
    simulated_s += 1000 * step_s;
    benchmark::DoNotOptimize(machine->spot_mm());
    if (machine->time_s() < stretch.length_s) continue;
    state.PauseTiming();
    machine = std::make_unique<BulletMachine>(stretch, step_s);
    state.ResumeTiming();
  }
  countTime(state, simulated_s, error_mm);
  state.counters["step ns"] = 1e9 * step_s;
}

}  // namespace

void registerBulletBenchmarks(const RecordedRun& label) {
  const auto stretch = std::make_shared<const Stretch>(stretchOf(label, kLength_s));
  const SpotTrack truth = exactTrack(*stretch);
  const auto bullet = [&](double step_s, double error_mm, const std::string& how) {
    char name[96];
    std::snprintf(name, sizeof(name), "bullet stepSimulation, %g us%s", 1e6 * step_s, how.c_str());
    benchmark::RegisterBenchmark(name, [stretch, step_s, error_mm](benchmark::State& state) {
      stepBullet(state, *stretch, step_s, error_mm);
    })->Unit(benchmark::kMillisecond);
  };
  double reference_error_mm = 0.0;
  for (const auto fidelity : {twin::Fidelity::kReference, twin::Fidelity::kFast}) {
    const bool reference = fidelity == twin::Fidelity::kReference;
    const double error_mm = largestError_mm(twinTrack(*stretch, fidelity), truth);
    if (reference) reference_error_mm = error_mm;
    benchmark::RegisterBenchmark(reference ? "model, reference" : "model, fast",
                                 [stretch, fidelity, error_mm](benchmark::State& state) {
                                   stepTwin(state, *stretch, fidelity, error_mm);
                                 })
        ->Unit(benchmark::kMillisecond);
  }
  // The method is of first order: error = slope * step. The slope of the smallest step that can be waited for
  // leads to the step at which the error would be the reference's. Rounding, which a real run there would
  // add, is not held against Bullet.
  constexpr std::array kSteps_s{10e-6, 5e-6, 2e-6, 1e-6, 0.5e-6};
  double slope_mm_s = 0.0;
  std::printf("Bullet's stepSimulation on %zu joints, %g s of %s, largest error of the spot:\n",
              BulletMachine(*stretch, 1e-6).joints(), kLength_s, label.name.c_str());
  for (const double step_s : kSteps_s) {
    const double error_mm = largestError_mm(bulletTrack(*stretch, step_s), truth);
    slope_mm_s = error_mm / step_s;
    std::printf("  %5.1f us: %9.3f um, %7.3f um/us\n", 1e6 * step_s, 1e3 * error_mm, 1e-3 * slope_mm_s);
    if (step_s == 10e-6 || step_s == 1e-6) bullet(step_s, error_mm, "");
  }
  bullet(reference_error_mm / slope_mm_s, reference_error_mm, ", as exact as the reference");
}

}  // namespace kerfbench::benchmarks

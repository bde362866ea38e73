// SPDX-License-Identifier: Apache-2.0
// Speed of the emulators as the bench runs them, each behind its pipe in quanta of half a millisecond: how
// many times as fast as the silicon.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "hil/base/one_processor.h"
#include "hil/source/open.h"
#include "tests/hil/source/mcs51/oracle.h"
#include "tests/hil/source/mcs51/program.h"

namespace kerfbench {
namespace {

namespace fs = std::filesystem;

const fs::path kBuild(KERFBENCH_BINARY_DIR);

struct Subject {
  const char* child;
  fs::path image;
  const char* mcu;
  std::uint64_t clock_hz;
  std::uint32_t baud;
};

void run(benchmark::State& state, const Subject& subject) {
  source::ChildSourceOptions options;
  options.child = kBuild / "bin" / subject.child;
  options.image = subject.image;
  options.mcu = subject.mcu;
  options.clock_hz = subject.clock_hz;
  options.baud = subject.baud;
  if (!fs::exists(options.child) || !fs::exists(options.image)) {
    state.SkipWithError("emulator or image was not built");
    return;
  }
  constexpr double kSpan_s = 0.1;
  constexpr double kQuantum_s = 0.5e-3;
  const std::unique_ptr<source::SignalSource> source = source::openChild(options);
  const TickRate rate = source->info().rate;
  base::OneProcessor together(source->info().process);  // As in a run.
  source::Batch batch;
  double simulated_s = 0.0;
  for (auto step : state) {
    (void)step;
    const double until_s = simulated_s + kSpan_s;
    while (simulated_s < until_s - 0.5 * kQuantum_s) {
      simulated_s += kQuantum_s;
      together.turn();
      if (source->advance(rate.ticksAt(simulated_s), batch) != source::Stop::kReached) {
        state.SkipWithError(source->message().c_str());
        return;
      }
    }
  }
  state.counters["times_the_silicon"] =
      benchmark::Counter(kSpan_s, benchmark::Counter::kIsIterationInvariantRate);
}

/// Timer 0 makes a pulse of P1.0 in every 50 cycles, as fast as a controller of this kind can; meanwhile the
/// program adds numbers.
fs::path pulsesOf8051() {
  mcs51_child::Program p;
  p.ljmp(0x40).at(0x0B).setb(mcs51_child::kP1_0).nop(4).clr(mcs51_child::kP1_0).reti();
  p.at(0x40).mov(mcs51_child::kTmod, 0x02).mov(mcs51_child::kTl0, 206).mov(mcs51_child::kTh0, 206);
  p.mov(mcs51_child::kIe, 0x82).setb(mcs51_child::kTr0);
  const unsigned loop = p.here();
  p.put({0x28, 0x39, 0xF5, 0x30, 0x26}).djnzR(7, loop).sjmp(loop);
  const fs::path image = kBuild / "tests/benchmarks/pulses-8051.hex";
  std::ofstream(image) << mcs51_child::intelHex(p.code());
  return image;
}

void add(const char* name, const Subject& subject) {
  benchmark::RegisterBenchmark(name, [subject](benchmark::State& state) { run(state, subject); })
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

void addAll() {
  const fs::path firmware = kBuild / "firmware";
  const fs::path images = kBuild / "tests/hil/source/cortex_m/firmware";
  const fs::path pulses = pulsesOf8051();
  add("avr_controller_idle",
      {"kerfbench-avr", firmware / "controller-avr.hex", "atmega2560", 16'000'000, 250'000});
  add("8051_12_clocks_pulses", {"kerfbench-mcs51", pulses, "at89s52", 12'000'000, 9600});
  add("8051_1_clock_pulses", {"kerfbench-mcs51", pulses, "stc15f2k60s2", 24'000'000, 125'000});
  add("8051_controller_idle",
      {"kerfbench-mcs51", firmware / "controller-mcs51.hex", "stc15w4k32s4", 24'000'000, 125'000});
  add("stm32_interrupt_100_kHz",
      {"kerfbench-cortex-m", images / "systick.elf", "stm32f103c8", 72'000'000, 250'000});
  add("stm32_controller_idle",
      {"kerfbench-cortex-m", firmware / "controller-stm32.hex", "stm32f103c8", 72'000'000, 250'000});
}

}  // namespace
}  // namespace kerfbench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  kerfbench::addAll();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}

// SPDX-License-Identifier: Apache-2.0
// Speed of the 8051 emulator, in machine cycles: a part at 12 MHz makes a million in a second.
#include <benchmark/benchmark.h>

#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

/// Timer 0 makes a pulse of P1.0 in every 50 cycles, as fast as a controller of this kind can; meanwhile the
/// program adds numbers, or waits.
Program pulseMaker(bool waits) {
  Program p;
  p.ljmp(0x40).at(0x0B).setb(kP1_0).nop(4).clr(kP1_0).reti();
  p.at(0x40).mov(kTmod, 0x02).mov(kTl0, 206).mov(kTh0, 206).mov(kIe, 0x82).setb(kTr0);
  if (waits) return p.halt();
  const unsigned loop = p.here();
  p.put({0x28, 0x39, 0xF5, 0x30, 0x26}).djnzR(7, loop).sjmp(loop);
  return p;
}

void runPart(benchmark::State& state, const char* part, bool waits) {
  Bench bench(part, pulseMaker(waits));
  Tick until = 0;
  const unsigned cycle = partCalled(part).cycle();
  constexpr Tick kCycles = 1'000'000;
  for (auto step : state) {
    (void)step;
    until += kCycles * cycle;
    benchmark::DoNotOptimize(bench.runTo(until));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCycles));
}

void runOfTwelveClocks(benchmark::State& state) { runPart(state, "at89s52", false); }
void runOfTwelveClocksWaiting(benchmark::State& state) { runPart(state, "at89s52", true); }
void runOfOneClock(benchmark::State& state) { runPart(state, "stc15f2k60s2", false); }
BENCHMARK(runOfTwelveClocks)->Unit(benchmark::kMillisecond);
BENCHMARK(runOfTwelveClocksWaiting)->Unit(benchmark::kMillisecond);
BENCHMARK(runOfOneClock)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kerfbench::mcs51_child

BENCHMARK_MAIN();
